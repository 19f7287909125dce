// Cameras of which something is known, and where the targets are that they see: for start_cameras.cpp, find_lenses.cpp
// and later_cameras.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "kinecal/config/cameras/target_poses.ipp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/sensors/lenses/lens.hpp"

namespace kinecal::detail {

/// True if a parameter of a camera is free in some step.
[[nodiscard]] inline bool is_free(const Config& config, const std::string& name) {
  return std::any_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
    return std::any_of(step.free_params.begin(), step.free_params.end(),
                       [&](const FreeParamConfig& free) { return free.name == name; });
  });
}

/// Makes the coefficients zero that are held: nothing is known of them.
inline void drop_held(const Config& config, const ModelConfig& camera, CameraInfo& info) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const auto coefficients = sensor->parameters().subspan(kIntrinsics);
  for (std::size_t i = 0; i < std::min(coefficients.size(), info.d.size()); ++i) {
    if (!is_free(config, parameter_name(camera.param_name, coefficients[i].name))) info.d[i] = 0.0;
  }
}

/// The camera_info of a camera in some sample; nullptr if none has one.
[[nodiscard]] inline const CameraInfo* info_of(const std::string& camera,
                                               const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen != nullptr && seen->camera) return &*seen->camera;
  }
  return nullptr;
}

/// True if a camera_info has intrinsics.
[[nodiscard]] inline bool is_known(const CameraInfo* info) {
  return info != nullptr && (info->k[0] > 0.0 || info->p[0] > 0.0);
}

/// What a camera sees of a target, by sample.
[[nodiscard]] inline std::vector<TargetView> views_of(const TargetPair& pair,
                                                      const std::vector<Sample>& samples) {
  std::vector<TargetView> views;
  for (const Sample& sample : samples) views.push_back(target_view(pair, sample));
  return views;
}

/// Gives a camera its first intrinsics in all samples.
inline void set_info(const std::string& camera, const CameraInfo& found,
                     std::vector<Sample>& samples) {
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != camera) continue;
      if (!seen.camera) seen.camera.emplace();
      const int width = seen.camera->width, height = seen.camera->height;
      seen.camera = found;
      seen.camera->width = width;
      seen.camera->height = height;
    }
  }
}

/// camera_T_target of each sample that has it, by a camera that is known.
[[nodiscard]] inline std::map<std::size_t, Pose<double>> poses_by(
    const CameraInfo& info, ImageKind image, const std::vector<TargetView>& views) {
  std::map<std::size_t, Pose<double>> poses;
  const Lens lens(info, image);
  for (std::size_t s = 0; s < views.size(); ++s) {
    const auto pose = pose_of_view(
        views[s], [&](const Eigen::Vector2d& pixel) { return lens.ray(pixel.x(), pixel.y()); });
    if (pose) poses.emplace(s, *pose);
  }
  return poses;
}

/// Takes away poses at which the camera does not see the corners that it saw: of a few corners, nearly on a line.
inline void drop_unseen(const TargetPair& pair, const CameraInfo& info,
                        const std::vector<TargetView>& views,
                        std::map<std::size_t, Pose<double>>& poses) {
  const Lens lens(info, pair.camera->image);
  std::erase_if(poses, [&](const auto& of) {
    return std::any_of(views[of.first].plane.begin(), views[of.first].plane.end(),
                       [&](const Eigen::Vector2d& p) {
                         const Vector3<double> at(p.x(), p.y(), 0.0);
                         return !lens.project(of.second * at).allFinite();
                       });
  });
}

/// Finds where cameras stand (place_cameras()), and gives the samples the poses of their targets.
/// @returns  as place_cameras()
inline std::map<std::string, Pose<double>> place(Config& config, const Robot& robot,
                                                 const std::vector<SeenTarget>& seen,
                                                 std::vector<Sample>& samples) {
  const Robot begun = at_initial_values(config, robot);
  auto cameras = place_cameras(config, begun, seen);
  set_poses(config, begun, seen, cameras, samples);
  return cameras;
}

}  // namespace kinecal::detail
