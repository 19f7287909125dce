// A rig of two cameras that see a board which a person holds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/built_in_sensor.hpp"
#include "kinecal/sensors/lens_camera.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal::test {

/// Two cameras on a body, and what they see of a board that a person holds, to rounding.
struct Rig {
  CameraInfo left, right;
  std::vector<Sample> samples;  ///< nothing is known of the cameras but the size of their images
  std::vector<Pose<double>> boards;  ///< left_T_board of each
};

inline Rig two_cameras(const std::string& lens, double focal, const std::vector<double>& left_d,
                       const std::vector<double>& right_d, double noise) {
  Rig rig;
  CameraInfo &left = rig.left, &right = rig.right;
  left.width = right.width = 1280;
  left.height = right.height = 960;
  left.distortion_model = right.distortion_model = lens;
  left.k = {focal, 0, 645, 0, focal + 2.0, 470, 0, 0, 1};
  right.k = {focal + 80.0, 0, 630, 0, focal + 78.0, 490, 0, 0, 1};
  left.d = left_d;
  right.d = right_d;
  const Pose<double> left_T_right{exp(Vector3<double>(0.02, 0.4, -0.03)), {0.12, -0.01, 0.02}};
  const auto camera = any_built_in(lens_camera(lens, ImageKind::raw));
  SeededRandom random(3);
  while (rig.samples.size() < 30) {
    const Pose<double> left_T_board{
        exp(Vector3<double>(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6),
                            random.uniform(-3.0, 3.0))),
        {random.uniform(-0.5, 0.7), random.uniform(-0.4, 0.4), random.uniform(0.3, 0.7)}};
    Sample sample;
    Observation board{"board", {}, {}};
    const auto see = [&](const std::string& name, const CameraInfo& info,
                         const Pose<double>& pose) {
      CameraInfo blank;
      blank.width = info.width;
      blank.height = info.height;
      Observation eye{name, {}, blank};
      const auto settings = camera->settings({name, {}, info});
      for (int i = 0; i < 48; ++i) {
        const Vector3<double> p = pose * Vector3<double>(0.06 * (i % 8), 0.06 * (i / 8), 0.0);
        const Eigen::Vector2d pixel = camera->predict(p, settings);
        const double u = noise * random.normal(), v = noise * random.normal();
        const bool is_inside =
            pixel.x() > 0.0 && pixel.x() < info.width && pixel.y() > 0.0 && pixel.y() < info.height;
        if (is_inside)
          eye.features.push_back({name, {pixel.x() + u, pixel.y() + v, 0.0}, {}, {}, i});
      }
      sample.observations.push_back(eye);
    };
    for (int i = 0; i < 48; ++i) {
      board.features.push_back({"board", {0.06 * (i % 8), 0.06 * (i / 8), 0.0}, {}, {}, i});
    }
    sample.observations.push_back(board);
    see("left", left, left_T_board);
    if (rig.samples.size() % 3 != 0) see("right", right, left_T_right.inverse() * left_T_board);
    sample.source = "view " + std::to_string(rig.samples.size());
    rig.samples.push_back(sample);
    rig.boards.push_back(left_T_board);
  }
  return rig;
}

inline Rig two_fisheyes(double noise = 0.0) {
  return two_cameras("equidistant", 420.0, {0.02, -0.004, 1e-3, -1e-4}, {-0.01, 0.003, 0.0, 0.0},
                     noise);
}

}  // namespace kinecal::test
