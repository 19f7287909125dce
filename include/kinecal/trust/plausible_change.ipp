// Plausible changes of parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numbers>
#include <string>

#include "kinecal/trust/judge.hpp"

namespace kinecal::detail {

/// Two limits of a figure: from the first, use with care; from the second, do not use.
struct Limits {
  double care, refuse;

  [[nodiscard]] bool exceeded(double figure) const { return !(figure < care); }
  [[nodiscard]] Grade grade(double figure) const {
    return !(figure < refuse) ? Grade::do_not_use : Grade::use_with_care;
  }
};

/// The largest plausible change of a parameter; a frame that was searched for, or that is not in
/// the URDF, may be anywhere.
[[nodiscard]] inline Limits plausible_change(const CalibrationStep& step, int parameter) {
  const AnyProblem& problem = *step.problem;
  constexpr double kNever = 1e300, kDegree = std::numbers::pi / 180.0;
  const Parameter& p = problem.table()[parameter];
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  if (p.name == owner && problem.robot().has_joint(owner)) {
    if (p.unit == "m") return {0.1, 0.5};
    return {15.0 * kDegree, 45.0 * kDegree};
  }
  const bool searched = std::any_of(
      step.unknown_frames.begin(), step.unknown_frames.end(),
      [&](const UnknownFrame& frame) { return frame.name == owner && !frame.has_guess; });
  if (searched) return {kNever, kNever};
  if (problem.robot().has_joint(owner)) {  // robots are built more precisely than their mounts
    const bool moving = moves(problem.robot().joint(owner).type);
    if (p.unit == "m") return moving ? Limits{0.05, 0.3} : Limits{0.2, 1.0};
    return moving ? Limits{15.0 * kDegree, 60.0 * kDegree} : Limits{30.0 * kDegree, kNever};
  }
  if (problem.frames().contains(owner)) return {kNever, kNever};
  if (p.unit == "m") return {0.1, kNever};
  return p.unit == "1" ? Limits{0.09, 0.3} : Limits{kNever, kNever};
}

}  // namespace kinecal::detail
