// Definitions of sampled_chain.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/kinematics/pose_walker.hpp"
#include "kinecal/problem/sample_reading.ipp"
#include "kinecal/problem/sampled_chain.hpp"

namespace kinecal {

KINECAL_INLINE SampledChain::SampledChain(const Robot& robot, RuntimeChain chain,
                                          const ParameterTable& table, int lag)
    : chain_(std::move(chain)),
      parameters_(chain_parameters(chain_, table)),
      effects_(chain_.joints.size()) {
  const auto add = [&](std::size_t joint, int index, Effect effect) {
    parameters_[joint].model.push_back(index);
    effects_[joint].push_back(std::move(effect));
    if (robot_ == nullptr) robot_ = std::make_shared<const Robot>(robot);
  };
  for (int p = 0; p < table.size(); ++p) {
    const std::optional<JointModelParameter> of = joint_model_parameter(robot, table[p].name);
    if (!of) continue;
    if (!of->fault.empty()) {
      throw RobotError("parameter '" + table[p].name + "': joint '" + of->joint + "' " + of->fault);
    }
    const bool of_mimic = robot.joint(of->joint).mimic.has_value();
    for (std::size_t i = 0; i < chain_.joints.size(); ++i) {
      const ChainJoint& joint = chain_.joints[i];
      if (!moves(joint.type) || (of_mimic ? joint.name : joint.drive.joint) != of->joint) continue;
      add(i, p, {*of, of_mimic ? 1.0 : joint.drive.multiplier});
    }
  }
  for (std::size_t i = 0; lag >= 0 && i < chain_.joints.size(); ++i) {
    const ChainJoint& joint = chain_.joints[i];
    if (!moves(joint.type)) continue;
    JointModelParameter of;
    of.joint = joint.drive.joint;
    add(i, lag, {std::move(of), joint.drive.multiplier});
  }
}

KINECAL_INLINE bool SampledChain::has_joints(const Sample& sample) const {
  return std::all_of(chain_.joints.begin(), chain_.joints.end(),
                     [&](const ChainJoint& joint) {
                       return !moves(joint.type) || sample.position(joint.drive.joint);
                     }) &&
         std::all_of(effects_.begin(), effects_.end(), [&](const std::vector<Effect>& of_joint) {
           return std::all_of(of_joint.begin(), of_joint.end(), [&](const Effect& effect) {
             const JointModelParameter& of = effect.parameter;
             return of.model == nullptr || of.model->partner() != ModelPartner::joint ||
                    sample.position(of.partner);
           });
         });
}

KINECAL_INLINE ModelledMotions SampledChain::motions(const Sample& sample, Unknown unknown) const {
  ModelledMotions all;
  all.measured = measured_joint_states(
      chain_, [&](const std::string& joint) { return detail::position_in(sample, joint); });
  all.all_effects.resize(effects_.size());
  if (robot_ == nullptr) return all;
  detail::SampleLoads loads(*robot_, sample);
  for (std::size_t i = 0; i < effects_.size(); ++i) {
    for (const Effect& effect : effects_[i]) {
      const JointModelParameter& of = effect.parameter;
      const detail::SampleReading reading(sample, of.joint, loads, unknown == Unknown::at_rest);
      const double unit =
          of.model == nullptr ? reading.velocity() : of.model->effect(of.part, reading, of.partner);
      if (!std::isfinite(unit)) {
        throw SampleError("the effect of a joint model of '" + of.joint + "' is not a number");
      }
      all.all_effects[i].push_back(effect.factor * unit);
    }
  }
  return all;
}

KINECAL_INLINE Pose<double> SampledChain::tip(const Sample& sample,
                                              const Corrections<double>& corrections) const {
  PoseWalker<double> walker;
  walk(chain_, motions(sample), corrections, walker);
  return walker.pose;
}

}  // namespace kinecal
