// The joint models that a robot's joints may have, as candidates: for identified_config.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/parameters/joint_models.hpp"
#include "kinecal/problem/sample_reading.ipp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/identify/candidates.ipp"

namespace kinecal::detail {

/// Parameters that come in together.
struct ModelCandidate {
  int rank = 0;  ///< see IdentifyRank
  std::vector<std::string> parameters;
};

/// True if all samples say what a model needs, and its parameters have different effects in them: backlash needs a
/// joint that came from both sides, five times at least.
[[nodiscard]] inline bool has_effect(const AnyJointModel& model, const Robot& robot,
                                     const Joint& joint, std::span<const Sample> samples) {
  constexpr int kFewest = 5;
  int other = 0;
  std::optional<double> first;
  try {
    for (const Sample& sample : samples) {
      SampleLoads loads(robot, sample);
      const SampleReading reading(sample, joint.name, loads, false);
      const double effect = model.effect(0, reading, {});
      if (effect != 0.0 && !first) first = effect;
      if (first && effect != 0.0 && effect != *first) ++other;
    }
  } catch (const SampleError&) {  // samples without joints are reported elsewhere
    return false;
  }
  return other >= kFewest;
}

/// True if all samples have the velocities of joints, and some moved.
[[nodiscard]] inline bool have_velocities(const std::vector<const Joint*>& joints,
                                          std::span<const Sample> samples) {
  constexpr double kMoves = 1e-2;  // rad/s or m/s
  bool moved = false;
  for (const Sample& sample : samples) {
    for (const Joint* joint : joints) {
      const std::optional<double> velocity = sample.velocity(joint->name);
      if (!velocity || !std::isfinite(*velocity)) return false;
      moved |= std::abs(*velocity) > kMoves;
    }
  }
  return moved;
}

/// The chains from the base to the sensors.
[[nodiscard]] inline std::vector<RuntimeChain> chains_to_sensors(const Config& config,
                                                                 const Robot& robot) {
  std::vector<RuntimeChain> chains;
  for (const ModelConfig& model : config.steps.front().models) {
    if (!robot.has_link(model.frame) || !robot.has_link(config.base_link)) continue;
    chains.push_back(make_chain(robot, config.base_link, model.frame));
  }
  return chains;
}

/// The joints that move right before and after a joint in a chain.
[[nodiscard]] inline std::set<std::string> neighbours_of(const std::string& joint,
                                                         const std::vector<RuntimeChain>& chains) {
  std::set<std::string> neighbours;
  for (const RuntimeChain& chain : chains) {
    std::vector<std::string> moving;
    for (const ChainJoint& one : chain.joints) {
      if (moves(one.type)) moving.push_back(one.drive.joint);
    }
    for (std::size_t i = 0; i < moving.size(); ++i) {
      if (moving[i] != joint) continue;
      if (i > 0) neighbours.insert(moving[i - 1]);
      if (i + 1 < moving.size()) neighbours.insert(moving[i + 1]);
    }
  }
  neighbours.erase(joint);
  return neighbours;
}

/// Links beyond a joint whose masses could pull at it, at least 0.15 m apart, and the last ones.
[[nodiscard]] inline std::set<std::string> links_beyond(const Robot& robot,
                                                        const std::string& joint,
                                                        const std::vector<RuntimeChain>& chains) {
  constexpr double kApart = 0.15;  // metres
  std::set<std::string> links;
  for (const RuntimeChain& chain : chains) {
    bool beyond = false;
    double way = 0.0;
    for (const ChainJoint& one : chain.joints) {
      if (beyond) way += one.fixed.translation.norm();
      if (beyond && way > kApart && moves(one.type)) {
        links.insert(robot.joint(one.name).child);
        way = 0.0;
      }
      beyond |= one.drive.joint == joint && !one.reversed;
    }
    if (beyond && way + chain.tail.translation.norm() > 0.0) links.insert(chain.tip);
  }
  return links;
}

/// Joint models of the joints that move a sensor, and lags of the sensors.  Couplings are of neighbours;
/// where the URDF has no masses, sag is by the mass of a link.
[[nodiscard]] inline std::vector<ModelCandidate> model_candidates(const Config& config,
                                                                  const Robot& robot,
                                                                  std::span<const Sample> samples) {
  std::vector<ModelCandidate> all;
  const std::vector<RuntimeChain> chains = chains_to_sensors(config, robot);
  std::vector<const Joint*> joints = moving_joints(config, robot);
  const auto add_models = [&](const Joint& joint) {
    int rank = kJointModel;
    for (const auto& model : joint_models()) {
      const int own = rank++;
      if (!model->suits(joint.type, joint.mimic.has_value())) continue;
      if (model->needs_masses() && robot.weight().links.empty()) continue;
      std::vector<std::string> names;
      for (const ParameterInfo& info : model->parameters()) {
        names.push_back(parameter_name(joint.name, info.name));
      }
      if (model->partner() == ModelPartner::none) {
        if (has_effect(*model, robot, joint, samples)) all.push_back({own, std::move(names)});
      } else if (model->partner() == ModelPartner::link) {
        if (!robot.weight().links.empty()) continue;
        for (const std::string& link : links_beyond(robot, joint.name, chains)) {
          ModelCandidate& of_link = all.emplace_back(ModelCandidate{own, names});
          for (std::string& name : of_link.parameters) name += "_" + link;
        }
      } else if (model->partner() == ModelPartner::joint && !joint.mimic) {
        for (const std::string& other : neighbours_of(joint.name, chains)) {
          ModelCandidate& with_other = all.emplace_back(ModelCandidate{own, names});
          for (std::string& name : with_other.parameters) name += "_" + other;
        }
      }
    }
  };
  for (const Joint* joint : joints) add_models(*joint);
  std::set<std::string> mimics;
  for (const RuntimeChain& chain : chains) {
    for (const ChainJoint& joint : chain.joints) {
      if (!moves(joint.type) || joint.drive.joint == joint.name) continue;
      if (mimics.insert(joint.name).second) add_models(robot.joint(joint.name));
    }
  }
  if (!have_velocities(joints, samples)) return all;
  for (const ModelConfig& model : config.steps.front().models) {
    if (!robot.has_link(model.frame)) continue;
    const auto moves_it = [](const ChainJoint& joint) { return moves(joint.type); };
    const RuntimeChain chain = make_chain(robot, config.base_link, model.frame);
    if (std::any_of(chain.joints.begin(), chain.joints.end(), moves_it)) {
      const std::string prefix = model.param_name.empty() ? model.name : model.param_name;
      all.push_back({kLagOfSensor, {parameter_name(prefix, kLag.name)}});
    }
  }
  return all;
}

}  // namespace kinecal::detail
