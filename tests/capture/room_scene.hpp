// A depth camera on a robot that looks at the ground, a wall and its own arm, for tests.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <random>

#include "capture/led_scene.hpp"
#include "kinecal/capture/finders/region.hpp"

namespace kinecal {

/// The base is on the ground (z = 0), x is forward.  The camera is 1.1 m above it and looks down.
struct RoomScene {
  double tilt = 0.7;     ///< of the camera, radians down
  double noise = 0.002;  ///< of depth, times z^2, metres
  double ground = 0.0;   ///< height of the ground, metres
  double wall = 3.0;     ///< x of a wall, metres
  bool arm = false;      ///< a vertical box at x 0.6 to 0.7, up to 0.5 m
  double missing = 0.1;  ///< share of pixels without depth
  double clutter = 0.0;  ///< share of pixels with any depth
  int width = 640, height = 480;

  Pose<double> base_T_camera() const {
    const double c = std::cos(tilt), s = std::sin(tilt);
    Pose<double> pose;  // columns: right, down and forward of the camera
    pose.rotation << 0, -s, c, -1, 0, 0, 0, -c, -s;
    pose.translation = {0.1, 0.0, 1.1};
    return pose;
  }

  Region region() const {
    Region region;
    region.frame = "base_link";
    region.frame_T_camera = [pose = base_T_camera()](const View&) { return pose; };
    region.least = {-2.0, -2.0, -2.0};
    region.most = {4.0, 2.0, 2.0};
    return region;
  }

  View view() const {
    View view{{}, "optical", vga_camera(), {}, {}, {}};
    view.camera->width = width;
    view.camera->height = height;
    const double scale = width / 640.0;
    view.camera->p = {kFocal * scale,
                      0,
                      0.5 * (width - 1),
                      0,
                      0,
                      kFocal * scale,
                      0.5 * (height - 1),
                      0,
                      0,
                      0,
                      1,
                      0};
    DepthImage depth(width, height);
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> uniform;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        double z = depth_at((u - view.camera->p[2]) / (kFocal * scale),
                            (v - view.camera->p[6]) / (kFocal * scale));
        z += noise * z * z * normal(random);
        if (uniform(random) < clutter) z = 0.5 + 2.0 * uniform(random);
        depth(u, v) = uniform(random) < missing ? 0.0F : static_cast<float>(z);
      }
    }
    view.points = points_of(depth, *view.camera);
    return view;
  }

  /// Depth along the ray (x, y, 1).
  double depth_at(double x, double y) const {
    const Pose<double> pose = base_T_camera();
    const Vector3<double> ray = pose.rotation * Vector3<double>(x, y, 1.0);
    const Vector3<double>& eye = pose.translation;
    double z = 9.0;
    if (ray.z() < 0.0) z = std::min(z, (ground - eye.z()) / ray.z());
    if (ray.x() > 0.0) z = std::min(z, (wall - eye.x()) / ray.x());
    const double front = (0.6 - eye.x()) / ray.x();
    const Vector3<double> p = eye + front * ray;
    if (arm && front > 0.0 && std::abs(p.y()) < 0.1 && p.z() > 0.0 && p.z() < 0.5) {
      z = std::min(z, front);
    }
    return z;
  }
};

}  // namespace kinecal
