// Random starts: joints and frames moved within the ranges of starts.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <numbers>
#include <random>

#include "kinecal/solve/starts.hpp"

namespace kinecal::detail {

/// The range of a parameter's random offset; zero for those of sensors and error blocks.
/// @returns  radians or metres, to either side
[[nodiscard]] inline double random_reach(const AnyProblem& problem, int parameter) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Parameter& p = problem.table()[parameter];
  const std::string& owner = problem.owners()[static_cast<std::size_t>(parameter)];
  const bool turns = p.unit == "rad";
  if (p.name == owner) {
    return turns ? random_start::kJointDegrees * kDegree : random_start::kJointMetres;
  }
  if (!is_frame_parameter(p.name, owner)) return 0.0;
  return turns ? random_start::kFrameDegrees * kDegree : random_start::kFrameMetres;
}

/// Values with the free joints and frames moved.
/// @param n  number of the start, used as its seed
[[nodiscard]] inline Eigen::VectorXd random_start_near(const AnyProblem& problem,
                                                       const FreeSet& free, Eigen::VectorXd values,
                                                       int n) {
  std::mt19937_64 engine(static_cast<std::uint64_t>(n) + 1);
  engine.discard(16);  // similar seeds give similar first numbers
  for (const int p : free.parameters()) {
    const double unit = static_cast<double>(engine() >> 11) * 0x1p-53;  // the same on all platforms
    values(p) += (2.0 * unit - 1.0) * random_reach(problem, p);
  }
  return values;
}

}  // namespace kinecal::detail
