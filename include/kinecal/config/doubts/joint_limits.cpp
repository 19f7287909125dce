// Definitions of joint_limits.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/joint_limits.hpp"

#include <algorithm>
#include <numbers>

namespace kinecal::detail {

double excess_of(const UsedJoint& joint, double position) {
  if (!joint.limits) return 0.0;
  return std::max({joint.limits->lower - position, position - joint.limits->upper, 0.0});
}

bool is_outside(const UsedJoint& joint, double position) {
  const double margin = turns(joint.joint.type) ? 0.35 : 0.1;  // 20 degrees, 10 cm
  if (excess_of(joint, position) <= margin) return false;
  if (!turns(joint.joint.type)) return true;
  const double turn = 2 * std::numbers::pi;
  return excess_of(joint, position - turn) > margin && excess_of(joint, position + turn) > margin;
}

bool fits_turned(const UsedJoint& joint, double turn) {
  constexpr double kRounding = 0.01;  // radians
  return std::all_of(joint.positions.begin(), joint.positions.end(),
                     [&](double q) { return excess_of(joint, q + turn) <= kRounding; });
}

std::optional<double> turn_into_limits(const UsedJoint& joint) {
  if (!joint.limits || !turns(joint.joint.type)) return std::nullopt;
  constexpr double kHalf = std::numbers::pi;
  for (const double turn : {0.5 * kHalf, -0.5 * kHalf, kHalf, -kHalf}) {
    if (fits_turned(joint, turn)) return turn;
  }
  return std::nullopt;
}

}  // namespace kinecal::detail
