// Random positions of joints: for generated_poses.ipp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <random>
#include <string>

#include "kinecal/kinematics/floating_joint.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

/// From -1 to 1; equal for equal seeds on every platform.
[[nodiscard]] inline double random_number(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-52 - 1.0;
}

/// A joint of a robot, or a coordinate of a floating one.
[[nodiscard]] inline Joint driven(const Robot& robot, const std::string& name) {
  const auto part = floating_coordinate(name);
  if (!part) return robot.joint(name);
  return {name, part->index < 3 ? JointType::prismatic : JointType::continuous, {}, {}};
}

/// A position within limits; without limits, up to half a turn or half a metre to either side.
[[nodiscard]] inline double random_position(const Joint& joint, std::mt19937_64& random) {
  const double most = turns(joint.type) ? std::numbers::pi : 0.5, share = random_number(random);
  const bool limited = joint.type != JointType::continuous && joint.limits &&
                       joint.limits->upper > joint.limits->lower;
  if (!limited) return most * share;
  return 0.5 * (joint.limits->lower + joint.limits->upper) +
         0.5 * share * (joint.limits->upper - joint.limits->lower);
}

}  // namespace kinecal::detail
