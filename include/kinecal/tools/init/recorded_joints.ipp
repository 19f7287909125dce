// The joints that samples have: for answers_from_samples.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/tools/init/init_answers.hpp"
#include "kinecal/tools/init/robot_parts.hpp"

namespace kinecal::detail {

/// @throws InputError  if the samples have joints, but none of the robot's
inline void check_joints_of(const Robot& robot, const std::vector<Sample>& samples) {
  std::set<std::string> names;
  for (const Sample& sample : samples) {
    names.insert(sample.joint_names.begin(), sample.joint_names.end());
  }
  if (names.empty() || std::any_of(names.begin(), names.end(), [&](const std::string& name) {
        return robot.has_joint(name);
      })) {
    return;
  }
  throw InputError(
      fmt::format("--from: none of the joints of the samples ({}, ...) is in the URDF of '{}'; "
                  "give the URDF of their robot",
                  *names.begin(), robot.name()));
}

/// The link from which all joints are in the samples, if both ends hang on it: the joint of a rail or a torso that
/// nobody recorded moves them together.  Empty if no joint is missing, or one beyond a recorded joint.
[[nodiscard]] inline std::string recorded_base(const Robot& robot,
                                               const std::vector<Sample>& samples,
                                               const InitAnswers& answers) {
  const std::string& end = needs_arm(answers.target) ? answers.arm : answers.camera;
  if (!robot.has_link(end)) return "";
  const bool has_both = needs_arm(answers.target) && needs_camera(answers.target);
  std::set<std::string> of_other;  // joints that move the other end, too
  if (has_both && robot.has_link(answers.camera)) {
    for (const Joint* joint : joints_to_root(robot, answers.camera)) of_other.insert(joint->name);
  }
  std::string base;
  for (const Joint* joint : joints_to_root(robot, end)) {  // from the end
    if (joint->type == JointType::floating || joint->type == JointType::planar) break;
    if (!moves(joint->type)) continue;
    const std::string driver = drive(robot, *joint).joint;
    const bool is_recorded = std::any_of(samples.begin(), samples.end(), [&](const Sample& sample) {
      return sample.position(driver).has_value();
    });
    if (is_recorded && !base.empty()) return "";
    if (is_recorded || !base.empty()) continue;
    if (has_both && !of_other.contains(joint->name)) return "";
    base = joint->child;
  }
  return base;
}

}  // namespace kinecal::detail
