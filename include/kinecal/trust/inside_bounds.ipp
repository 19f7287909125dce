// The free parameters that are not at a bound.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// The free parameters that are not at a bound.
[[nodiscard]] inline FreeSet inside_bounds(const AnyProblem& problem, const FreeSet& free,
                                           ParameterValues values, std::vector<int>& held) {
  std::vector<int> inside;
  for (const int p : free.parameters()) {
    const Parameter& parameter = problem.table()[p];
    const double value = values[static_cast<std::size_t>(p)];
    constexpr double kAtBound = 1e-9;
    const double near = kAtBound * (1e-3 + std::abs(value));
    const bool at = value <= parameter.lower + near || value >= parameter.upper - near;
    (at ? held : inside).push_back(p);
  }
  return FreeSet(std::move(inside), problem.table().size());
}

}  // namespace kinecal::detail
