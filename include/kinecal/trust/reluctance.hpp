// Which parameters are held rather than others, if samples do not determine all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// How readily a parameter is held: 0 for parameters of frames, 1 for those of sensors and blocks, 2
/// for joints.
[[nodiscard]] inline int reluctance(const AnyProblem& problem, int parameter) {
  const std::string& name = problem.table()[parameter].name;
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  if (name == owner) return 2;
  const auto is_axis = [&](std::string_view axis) { return name == parameter_name(owner, axis); };
  return std::any_of(kFrameAxes.begin(), kFrameAxes.end(), is_axis) ? 0 : 1;
}

}  // namespace kinecal::detail
