// What may be wrong with a robot, in a configuration: for identified_config.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

/// What an engineer names first: zeros, then mounts, sensors, lags, the arm's geometry, then joint models in
/// the order of joint_models().
enum IdentifyRank { kZero, kMount, kOfSensor, kLagOfSensor, kGeometry, kJointModel };

/// A model with the chain from the base to its sensor or target.
struct ModelChain {
  const ModelConfig* model = nullptr;
  RuntimeChain chain;
};

/// The chains of all models that the robot has the links of.
[[nodiscard]] inline std::vector<ModelChain> model_chains(const Config& config,
                                                          const Robot& robot) {
  std::vector<ModelChain> chains;
  for (const ModelConfig& model : config.steps.front().models) {
    if (!robot.has_link(model.frame) || !robot.has_link(config.base_link)) continue;
    chains.push_back({&model, make_chain(robot, config.base_link, model.frame)});
  }
  return chains;
}

/// The joints that move some sensor or target, in the order of the robot; not those that mimic others.
[[nodiscard]] inline std::vector<const Joint*> moving_joints(const std::vector<ModelChain>& chains,
                                                             const Robot& robot) {
  std::set<std::string> names;
  for (const ModelChain& of : chains) {
    for (const ChainJoint& joint : of.chain.joints) names.insert(joint.drive.joint);
  }
  std::vector<const Joint*> joints;
  for (const Joint& joint : robot.joints()) {
    if (names.contains(joint.name)) joints.push_back(&joint);
  }
  return joints;
}

[[nodiscard]] inline bool is_free(const StepConfig& step, const std::string& name) {
  const std::vector<FreeParamConfig> all = free_parameters(step);
  return std::any_of(all.begin(), all.end(), [&](const auto& free) { return free.name == name; });
}

/// The parameters of a sensor that may be wrong: of a camera of rectified images, not those of its lens; of
/// the polynomial of a depth camera, those that the step frees.
[[nodiscard]] inline std::vector<std::string> sensor_parameters(const StepConfig& step,
                                                                const ModelConfig& model) {
  const SensorEntry* entry = entry_of(model);
  if (entry == nullptr) return {};
  const std::shared_ptr<const AnySensor> sensor = sensor_of(model);
  const bool has_lens = !entry->lenses.empty() && model.image != ImageKind::rectified;
  std::vector<std::string> names;
  for (const ParameterInfo& info : sensor->parameters()) {
    const bool is_of_lens = !entry->lenses.empty() && names.size() >= kIntrinsics;
    const std::string name = parameter_name(model.param_name, info.name);
    const bool is_bend = model.type == DepthCamera::kType &&
                         names.size() >= DepthCamera::kWithoutPolynomial && !is_free(step, name);
    if (!is_bend && (!is_of_lens || has_lens)) names.push_back(name);
  }
  return names;
}

/// True for a frame that is free from the beginning: it is not in the URDF, or no motor moves it.
[[nodiscard]] inline bool is_base_frame(const Robot& robot, const FreeFrameConfig& frame) {
  return !frame.is_fixed && (!robot.has_joint(frame.name) || !moves(robot.joint(frame.name).type));
}

/// Frees one axis of a frame.
inline void free_axis(StepConfig& step, const std::string& frame, std::size_t axis) {
  auto known = std::find_if(step.free_frames.begin(), step.free_frames.end(),
                            [&](const FreeFrameConfig& of) { return of.name == frame; });
  if (known == step.free_frames.end())
    known = step.free_frames.insert(known, {.name = frame, .place = {}});
  known->axes[axis] = true;
}

}  // namespace kinecal::detail
