// Compares positions of a joint with its limits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>

#include "kinecal/config/doubts/used_joints.hpp"

namespace kinecal::detail {

/// By how much a position is outside the limits, radians or metres; 0 inside.
[[nodiscard]] inline double excess_of(const UsedJoint& joint, double position) {
  if (!joint.limits) return 0.0;
  return std::max({joint.limits->lower - position, position - joint.limits->upper, 0.0});
}

/// True if a position is further outside than offsets of real robots explain.  Full turns do not
/// count.
[[nodiscard]] inline bool is_outside(const UsedJoint& joint, double position) {
  const double margin = turns(joint.joint.type) ? 0.35 : 0.1;  // 20 degrees, 10 cm
  if (excess_of(joint, position) <= margin) return false;
  if (!turns(joint.joint.type)) return true;
  const double turn = 2 * std::numbers::pi;
  return excess_of(joint, position - turn) > margin && excess_of(joint, position + turn) > margin;
}

/// A quarter or half turn that brings nearly all positions of a joint into its limits; nullopt if
/// none does.
[[nodiscard]] inline std::optional<double> turn_into_limits(const UsedJoint& joint) {
  if (!joint.limits || !turns(joint.joint.type)) return std::nullopt;
  constexpr double kHalf = std::numbers::pi;
  for (const double shift : {kHalf, -kHalf, 0.5 * kHalf, -0.5 * kHalf}) {
    const auto outside = std::count_if(joint.positions.begin(), joint.positions.end(),
                                       [&](double q) { return is_outside(joint, q + shift); });
    if (50 * outside <= std::ssize(joint.positions)) return shift;
  }
  return std::nullopt;
}

}  // namespace kinecal::detail
