// Definitions of sampled_chain.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <utility>

#include "kinecal/kinematics/pose_walker.hpp"
#include "kinecal/problem/sample_reading.hpp"
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
    if (!joint_model_parameter(robot, table[p].name)) continue;
    const JointModelParameter of = checked_joint_model(robot, table[p].name);
    const bool of_mimic = robot.joint(of.joint).mimic.has_value();
    for (std::size_t i = 0; i < chain_.joints.size(); ++i) {
      const ChainJoint& joint = chain_.joints[i];
      if (!moves(joint.type) || (of_mimic ? joint.name : joint.drive.joint) != of.joint) continue;
      add(i, p, {of, of_mimic ? 1.0 : joint.drive.multiplier});
    }
  }
  static const detail::JointModelOf<SensorLag> lag_model{SensorLag{}};
  for (std::size_t i = 0; lag >= 0 && i < chain_.joints.size(); ++i) {
    const ChainJoint& joint = chain_.joints[i];
    if (!joint.floating.empty()) {
      throw RobotError("a lag needs velocities, which the measured pose of floating joint '" +
                       joint.floating + "' does not have");
    }
    if (!moves(joint.type)) continue;
    add(i, lag, {{&lag_model, 0, joint.drive.joint, {}, {}, {}}, joint.drive.multiplier});
  }
}

KINECAL_INLINE bool SampledChain::has_joints(const Sample& sample) const {
  const auto has = [&](const std::string& joint) { return sample.position(joint).has_value(); };
  for (const ChainJoint& joint : chain_.joints) {
    if (moves(joint.type) && !has(joint.drive.joint)) return false;
  }
  for (const std::vector<Effect>& of_joint : effects_) {  // joints that move others along
    for (const Effect& effect : of_joint) {
      const JointModelParameter& of = effect.parameter;
      if (of.model->partner() == ModelPartner::joint && !has(of.partner)) return false;
    }
  }
  return true;
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
      const double unit = of.model->effect(of.part, reading, of.partner);
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
