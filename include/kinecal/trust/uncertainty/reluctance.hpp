// Which parameters to hold first if the samples do not determine all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// Order in which parameters are held: 0 for those of frames, 1 for sensors and blocks, 2 for
/// joints.
[[nodiscard]] inline int reluctance(const AnyProblem& problem, int parameter) {
  const std::string& name = problem.table()[parameter].name;
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  if (name == owner) return 2;
  return is_frame_parameter(name, owner) ? 0 : 1;
}

}  // namespace kinecal::detail
