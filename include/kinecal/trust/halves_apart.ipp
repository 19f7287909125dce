// Two halves of the poses, solved apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <stdexcept>

#include "kinecal/trust/projection_map.hpp"

namespace kinecal::detail {

/// The parameters after solving each half of the poses apart; nullopt if that fails.
[[nodiscard]] inline std::optional<std::array<Eigen::VectorXd, 2>> halves_of(
    const KnownSolution& solution) {
  constexpr int kFewest = 8;
  if (solution.poses.count < kFewest) return std::nullopt;
  std::array<Eigen::VectorXd, 2> halves;
  for (int half = 0; half < 2; ++half) {
    Eigen::VectorXd weights = solution.fit.loss;
    for (const RowBlock& block : solution.fit.blocks) {
      const int pose = solution.poses.of_sample[static_cast<std::size_t>(block.sample)];
      if (pose % 2 == half) weights.segment(block.first, block.size).setZero();
    }
    try {
      halves[static_cast<std::size_t>(half)] =
          refit(solution.evaluator, solution.values, solution.fit, weights, 0.5).values;
    } catch (const std::domain_error&) {  // a point behind a camera
      return std::nullopt;
    }
  }
  return halves;
}

}  // namespace kinecal::detail
