// Compares positions of a joint with its limits.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
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

/// True if all positions are within the limits when a turn is added, as far as limits are exact.
[[nodiscard]] inline bool fits_turned(const UsedJoint& joint, double turn) {
  constexpr double kRounding = 0.01;  // radians
  return std::all_of(joint.positions.begin(), joint.positions.end(),
                     [&](double q) { return excess_of(joint, q + turn) <= kRounding; });
}

/// The smallest quarter or half turn that brings all positions of a joint into its limits; nullopt
/// if none does.
[[nodiscard]] inline std::optional<double> turn_into_limits(const UsedJoint& joint) {
  if (!joint.limits || !turns(joint.joint.type)) return std::nullopt;
  constexpr double kHalf = std::numbers::pi;
  for (const double turn : {0.5 * kHalf, -0.5 * kHalf, kHalf, -kHalf}) {
    if (fits_turned(joint, turn)) return turn;
  }
  return std::nullopt;
}

}  // namespace kinecal::detail
