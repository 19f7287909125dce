// Configurations with which find_lenses() tries a lens.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/sensors/lens_names.hpp"
#include "kinecal/tools/cameras/camera_places.ipp"

namespace kinecal::detail {

/// Names of the parameters of a camera with a lens.
[[nodiscard]] inline std::set<std::string> names_with_lens(ModelConfig camera,
                                                           std::string_view lens) {
  camera.lens = lens;
  std::set<std::string> names;
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  for (const ParameterInfo& info : sensor->parameters()) {
    names.insert(parameter_name(camera.param_name, info.name));
  }
  return names;
}

/// The same with any lens.
[[nodiscard]] inline std::set<std::string> names_with_lenses(const ModelConfig& camera) {
  std::set<std::string> names;
  for (const std::string_view lens : lens_names()) names.merge(names_with_lens(camera, lens));
  return names;
}

/// The configuration with a lens whose intrinsics are free.
/// @param held  a coefficient that is not; empty: all are
[[nodiscard]] inline Config with_lens(Config config, const ModelConfig& camera,
                                      const std::string& lens, const std::string& held) {
  const std::set<std::string> others = names_with_lenses(camera);
  std::set<std::string> free = names_with_lens(camera, lens);
  if (!held.empty()) free.erase(parameter_name(camera.param_name, held));
  for (StepConfig& step : config.steps) {
    bool has_camera = false;
    for (ModelConfig& model : step.models) {
      if (model.name != camera.name) continue;
      has_camera = true;
      model.lens = lens;
      model.image = ImageKind::raw;
    }
    if (!has_camera) continue;
    std::erase_if(step.free_params, [&](const auto& param) { return others.contains(param.name); });
    for (const std::string& name : free) {
      step.free_params.push_back({name, camera.place});
    }
  }
  return config;
}

/// The configuration without the other cameras whose lens is to be found, so that none waits for another; and
/// without the free frame on which the camera stands, if no other camera is left to say where that is.
[[nodiscard]] inline Config without_others(Config config, const Robot& robot,
                                           const ModelConfig& camera) {
  std::set<std::string> cameras, parameters;
  for (const ModelConfig& model : models_of(config)) {
    if (model.lens != kAnyLens || model.name == camera.name) continue;
    cameras.insert(model.name);
    parameters.merge(names_with_lenses(model));
  }
  if (cameras.empty()) return config;
  const bool is_placed = is_placed_by_us(config, robot, camera);
  for (StepConfig& step : config.steps) {
    std::set<std::string> used;
    std::erase_if(step.error_blocks, [&](const BlockConfig& block) {
      const bool is_theirs =
          std::any_of(block.models.begin(), block.models.end(),
                      [&](const std::string& model) { return cameras.contains(model); });
      if (!is_theirs) used.insert(block.models.begin(), block.models.end());
      return is_theirs;
    });
    std::erase_if(step.models, [&](const auto& model) { return !used.contains(model.name); });
    std::erase_if(step.free_params,
                  [&](const auto& free) { return parameters.contains(free.name); });
  }
  const std::vector<TargetPair> left = target_pairs(config, robot);
  const bool is_only = std::all_of(left.begin(), left.end(), [&](const TargetPair& pair) {
    return pair.camera->name == camera.name;
  });
  std::set<std::string> joints;
  for (const Joint* joint : joints_between(config, robot)) joints.insert(joint->name);
  if (is_placed && is_only) joints.erase(robot.parent_joint(camera.frame)->name);
  for (StepConfig& step : config.steps) {
    const auto is_idle = [&](const auto& frame) {
      return robot.has_joint(frame.name) && !joints.contains(frame.name);
    };
    std::erase_if(step.free_frames, is_idle);
    std::erase_if(step.frame_initial_values, is_idle);
  }
  return config;
}

/// Gives the samples of a camera the camera_info of others.
inline void take_camera(const std::string& camera, const std::vector<Sample>& from,
                        std::vector<Sample>& samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const Observation* found = from[s].observation(camera);
    for (Observation& seen : samples[s].observations) {
      if (seen.sensor == camera && found != nullptr) seen.camera = found->camera;
    }
  }
}

}  // namespace kinecal::detail
