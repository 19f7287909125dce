// Masks of the arm with meshes (mesh_robot.hpp), as a camera beside it sees them; drawn by rays, one per pixel.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/finders/mask_finder.hpp"
#include "kinecal/surface/outline.hpp"
#include "support/mesh_robot.hpp"

namespace kinecal::test {

/// mesh_config() of masks in place of clouds.
inline std::string mask_config(const std::string& initial, const std::string& free_params = "") {
  std::string config = mesh_config(initial, "", free_params);
  for (const auto& [what, with] : {std::pair<std::string, std::string>("camera3d", "camera2d"),
                                   {"chain3d_to_mesh", "camera2d_to_mesh"}}) {
    config.replace(config.find(what), what.size(), with);
  }
  return config;
}

/// A pinhole of 320 x 240 pixels.
inline CameraInfo mask_camera() {
  CameraInfo info;
  info.width = 320;
  info.height = 240;
  info.distortion_model = "plumb_bob";
  info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  info.k = {260.0, 0.0, 158.0, 0.0, 260.0, 121.0, 0.0, 0.0, 1.0};
  info.p = {260.0, 0.0, 158.0, 0.0, 0.0, 260.0, 121.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

/// Its pixel of a point.
inline Eigen::Vector2d mask_pixel(const Vector3<double>& p) {
  const CameraInfo info = mask_camera();
  if (p.z() <= 0.0) return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  return {info.k[0] * p.x() / p.z() + info.k[2], info.k[4] * p.y() / p.z() + info.k[5]};
}

/// What a ray through a pixel hits.
inline SurfaceHit seen_at(const RobotSurface& surface, const std::vector<Pose<double>>& links,
                          const Pose<double>& base_T_camera, const Eigen::Vector2d& pixel) {
  const CameraInfo info = mask_camera();
  const Vector3<double> ray((pixel.x() - info.k[2]) / info.k[0],
                            (pixel.y() - info.k[5]) / info.k[4], 1.0);
  return surface.cast(links, base_T_camera.translation,
                      Vector3<double>(base_T_camera.rotation * ray));
}

inline GrayImage mask_of(const RobotSurface& surface, const std::vector<Pose<double>>& links,
                         const Pose<double>& base_T_camera) {
  GrayImage mask(mask_camera().width, mask_camera().height, 0);
  for (int v = 0; v < mask.height; ++v) {
    for (int u = 0; u < mask.width; ++u) {
      if (seen_at(surface, links, base_T_camera, {u, v}).link >= 0) mask(u, v) = 255;
    }
  }
  return mask;
}

/// Samples of the arm whose camera sees masks, from true_camera().
inline std::vector<Sample> mask_robot_samples(const Robot& robot, const CloudPlan& plan) {
  const RobotSurface surface = mesh_robot_surface();
  std::vector<Sample> samples = mesh_robot_samples(robot, plan);
  for (Sample& sample : samples) {
    std::map<std::string, double> q = positions_of(sample);
    for (const auto& [joint, offset] : plan.offsets) q[joint] += offset;
    View view;
    view.frame = "camera";
    view.camera = mask_camera();
    view.image = mask_of(surface, mesh_robot_poses(robot, q), true_camera());
    sample.observations = MaskFinder{}.find(view).observations;
  }
  return samples;
}

}  // namespace kinecal::test
