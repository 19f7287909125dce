// What may be wrong with a robot, in a configuration: for identified_config.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

/// What an engineer names first: zeros, then mounts, joints that are rigidly connected with these, sensors, lags, the
/// arm's geometry, then joint models in the order of joint_models().
enum IdentifyRank { kZero, kMount, kSameMount, kOfSensor, kLagOfSensor, kGeometry, kJointModel };

/// A model with the chain from the base to its sensor or target.
struct ModelChain {
  const ModelConfig* model = nullptr;
  RuntimeChain chain;
};

/// The chains of all models that the robot has the links of.
/// @param kept  fixed joints that stay joints of the chains
[[nodiscard]] inline std::vector<ModelChain> model_chains(const Config& config, const Robot& robot,
                                                          const std::set<std::string>& kept = {}) {
  std::vector<ModelChain> chains;
  for (const ModelConfig& model : config.steps.front().models) {
    for (const std::string& frame : model.frames()) {
      if (!robot.has_link(frame) || !robot.has_link(config.base_link)) continue;
      chains.push_back({&model, make_chain(robot, config.base_link, frame, kept)});
    }
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

/// True if the URDF has the pose of a joint: an identity is a placeholder.
[[nodiscard]] inline bool has_origin(const Joint& joint) {
  return !joint.origin.translation.isZero() || !joint.origin.rotation.isIdentity();
}

/// A fixed joint before the first or after the last moving joint of a chain: how a robot, a camera or a tool is mounted.
struct Mount {
  std::string joint;
  std::vector<int> ends;  ///< of chains, by number: mounts that are rigidly connected have the same
};

/// All mounts, from the base to the sensors.
[[nodiscard]] inline std::vector<Mount> mounts_of(const Config& config, const Robot& robot) {
  std::set<std::string> fixed;
  for (const Joint& joint : robot.joints()) {
    if (joint.type == JointType::fixed) fixed.insert(joint.name);
  }
  std::vector<Mount> mounts;
  int end = 0;
  const auto add = [&](auto from, auto to) {
    for (; from != to; ++from) {
      auto known = std::find_if(mounts.begin(), mounts.end(),
                                [&](const Mount& of) { return of.joint == from->name; });
      if (known == mounts.end()) known = mounts.insert(known, {from->name, {}});
      known->ends.push_back(end);
    }
    ++end;
  };
  for (const ModelChain& of : model_chains(config, robot, fixed)) {
    const std::vector<ChainJoint>& joints = of.chain.joints;
    const auto is_moving = [](const ChainJoint& joint) { return moves(joint.type); };
    const auto first = std::find_if(joints.begin(), joints.end(), is_moving);
    add(joints.begin(), first);
    if (first == joints.end()) continue;
    add(std::find_if(joints.rbegin(), joints.rend(), is_moving).base(), joints.end());
  }
  return mounts;
}

/// A mount that a configuration does not free.
struct HeldMount {
  std::string joint;
  int rank = kMount;  ///< kSameMount: rigidly connected with another one, as a flange with its tool
};

/// The mounts that a configuration does not free.  Of those that are rigidly connected, the one that is free has rank
/// kMount, or the last one with a translation: an optical frame is only turned.
[[nodiscard]] inline std::vector<HeldMount> held_mounts(const Config& config, const Robot& robot) {
  const std::vector<FreeFrameConfig>& free = config.steps.front().free_frames;
  const auto is_free = [&](const std::string& name) {
    return std::any_of(free.begin(), free.end(), [&](const auto& of) { return of.name == name; });
  };
  const std::vector<Mount> mounts = mounts_of(config, robot);
  std::map<std::vector<int>, std::string> named;  // of each rigid connection
  for (const Mount& mount : mounts) {
    std::string& of = named[mount.ends];
    const bool is_moved = robot.joint(mount.joint).origin.translation.norm() > 0.0;
    if (of.empty() || is_free(mount.joint) || (is_moved && !is_free(of))) of = mount.joint;
  }
  std::vector<HeldMount> held;
  for (const Mount& mount : mounts) {
    if (is_free(mount.joint)) continue;
    held.push_back({mount.joint, named[mount.ends] == mount.joint ? kMount : kSameMount});
  }
  return held;
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
