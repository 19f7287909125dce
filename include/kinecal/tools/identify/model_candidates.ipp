// The joint models that a robot's joints may have, as candidates: for identified_config.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/parameters_from_config.hpp"
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

/// A model of a joint, and whether samples say what it needs.
struct ModelProbe {
  int rank = 0;
  const AnyJointModel* model = nullptr;
  const Joint* joint = nullptr;
  std::optional<double> effect = {};  ///< that of its first parameter in some sample
  int others = 0;                     ///< samples in which that is another
  bool is_unknown = false;            ///< a sample does not say it

  /// True if the samples say it, and it differs: backlash needs a joint that came from both sides.
  [[nodiscard]] bool is_candidate() const {
    constexpr int kFewest = 5;
    return !is_unknown && others >= kFewest;
  }
};

/// Asks each model, without a partner, for its effect in each sample.
inline void ask_models(const Robot& robot, std::span<const Sample> samples,
                       std::vector<ModelProbe>& probes) {
  for (const Sample& sample : samples) {
    SampleLoads loads(robot, sample);
    for (ModelProbe& probe : probes) {
      if (probe.is_unknown) continue;
      try {
        const SampleReading reading(sample, probe.joint->name, loads, false);
        const double effect = probe.model->effect(0, reading, {});
        if (effect == 0.0) continue;
        if (!probe.effect) probe.effect = effect;
        probe.others += effect != *probe.effect ? 1 : 0;
      } catch (const SampleError&) {  // that joints are missing is reported elsewhere
        probe.is_unknown = true;
      }
    }
  }
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

/// The joints that move right before and after a joint in a chain.
[[nodiscard]] inline std::set<std::string> neighbours_of(const std::string& joint,
                                                         const std::vector<ModelChain>& chains) {
  std::set<std::string> neighbours;
  for (const ModelChain& of : chains) {
    std::string before;  // the joint that moves before
    for (const ChainJoint& one : of.chain.joints) {
      if (!has_position(one)) continue;
      if (one.drive.joint == joint) neighbours.insert(before);
      if (before == joint) neighbours.insert(one.drive.joint);
      before = one.drive.joint;
    }
  }
  neighbours.erase(joint);
  neighbours.erase("");
  return neighbours;
}

/// Links beyond a joint whose masses could pull at it, at least 0.15 m apart, and the last ones.
[[nodiscard]] inline std::set<std::string> links_beyond(const Robot& robot,
                                                        const std::string& joint,
                                                        const std::vector<ModelChain>& chains) {
  constexpr double kApart = 0.15;  // metres
  std::set<std::string> links;
  for (const ModelChain& of : chains) {
    bool beyond = false;
    double way = 0.0;
    for (const ChainJoint& one : of.chain.joints) {
      if (beyond) way += one.fixed.translation.norm();
      if (beyond && way > kApart && has_position(one)) {
        links.insert(robot.joint(one.name).child);
        way = 0.0;
      }
      beyond |= one.drive.joint == joint && !one.reversed;
    }
    if (beyond && way + of.chain.tail.translation.norm() > 0.0) links.insert(of.chain.tip);
  }
  return links;
}

/// Joint models of the joints that move a sensor, and lags of the sensors.  Couplings are of neighbours;
/// where the URDF has no masses, sag is by the mass of a link.
[[nodiscard]] inline std::vector<ModelCandidate> model_candidates(const Config& config,
                                                                  const Robot& robot,
                                                                  std::span<const Sample> samples) {
  std::vector<ModelCandidate> all;
  const std::vector<ModelChain> chains = model_chains(config, robot);
  const std::vector<const Joint*> moving = moving_joints(chains, robot);
  const bool has_masses = !robot.weight().links.empty();
  std::set<const Joint*> mimics;
  for (const ModelChain& of : chains) {
    for (const ChainJoint& joint : of.chain.joints) {
      if (has_position(joint) && joint.drive.joint != joint.name)
        mimics.insert(&robot.joint(joint.name));
    }
  }
  std::vector<const Joint*> joints = moving;
  joints.insert(joints.end(), mimics.begin(), mimics.end());
  const auto add = [&](int rank, const AnyJointModel& model, const Joint& joint,
                       const std::string& partner) {
    ModelCandidate& candidate = all.emplace_back(ModelCandidate{rank, {}});
    for (const ParameterInfo& info : model.parameters()) {
      const std::string name = parameter_name(joint.name, info.name);
      candidate.parameters.push_back(partner.empty() ? name : name + "_" + partner);
    }
  };
  std::vector<ModelProbe> probes;
  for (const Joint* joint : joints) {
    int rank = kJointModel;
    for (const auto& model : joint_models()) {
      const int own = rank++;
      if (!model->suits(joint->type, joint->mimic.has_value())) continue;
      if (model->needs_masses() && !has_masses) continue;
      if (model->partner() == ModelPartner::none) probes.push_back({own, model.get(), joint});
      if (model->partner() == ModelPartner::link && !has_masses) {
        for (const std::string& link : links_beyond(robot, joint->name, chains))
          add(own, *model, *joint, link);
      }
      if (model->partner() == ModelPartner::joint && !joint->mimic) {
        for (const std::string& other : neighbours_of(joint->name, chains))
          add(own, *model, *joint, other);
      }
    }
  }
  ask_models(robot, samples, probes);
  for (const ModelProbe& probe : probes) {
    if (probe.is_candidate()) add(probe.rank, *probe.model, *probe.joint, "");
  }
  if (!have_velocities(moving, samples)) return all;
  for (const ModelChain& of : chains) {
    const auto moves_it = [](const ChainJoint& joint) { return moves(joint.type); };
    if (std::any_of(of.chain.joints.begin(), of.chain.joints.end(), moves_it))
      all.push_back({kLagOfSensor, {lag_name(*of.model)}});
  }
  return all;
}

}  // namespace kinecal::detail
