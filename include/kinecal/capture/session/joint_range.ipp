// Random positions of joints, for robot_body.cpp and pose_generation.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <random>

#include "kinecal/kinematics/joint.hpp"

namespace kinecal::detail {

/// From 0 to 1; equal for equal seeds on every platform.
[[nodiscard]] inline double random_share(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

/// A position within limits; without limits, up to half a turn or half a metre to either side.
/// @param share  [0, 1]
[[nodiscard]] inline double position_in_range(const Joint& joint, double share) {
  const double most = turns(joint.type) ? std::numbers::pi : 0.5;
  const bool limited = joint.type != JointType::continuous && joint.limits &&
                       joint.limits->upper > joint.limits->lower;
  const double lower = limited ? joint.limits->lower : -most;
  const double upper = limited ? joint.limits->upper : most;
  return lower + share * (upper - lower);
}

}  // namespace kinecal::detail
