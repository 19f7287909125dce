// What residuals change by if samples said something else: other joint positions, other points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal::detail {

/// A fit and the samples that it is of.
struct FittedSamples {
  const AnyProblem& problem;
  const FreeSet& free;
  const LinearFit& fit;
  ParameterValues values;
  std::span<const Sample> samples;
};

/// (rows) derivatives of weighted residuals, by a forward difference; zero if some are undefined.
/// @param move     changes a sample a little
/// @param step     what the difference is divided by
[[nodiscard]] inline Eigen::VectorXd sample_slopes(const FittedSamples& fitted,
                                                   const std::function<void(Sample&)>& move,
                                                   double step) {
  const auto& [problem, free, fit, values, samples] = fitted;
  const std::unique_ptr<AnyProblem> moved = problem.without_samples();
  try {
    for (Sample sample : samples) {
      move(sample);
      moved->add_sample(sample);
    }
    moved->set_poses_of_samples(problem.poses_of_samples());
    const auto evaluator = moved->evaluator(free, 1);
    const LinearFit there = linear_fit(*evaluator, values, fit.coordinates, false);
    if (there.residual.size() == fit.residual.size()) {
      const Eigen::VectorXd slopes = (there.residual - fit.residual) / step;
      if (slopes.allFinite()) return slopes;
    }
  } catch (const SampleError&) {
  } catch (const std::domain_error&) {  // a point behind a camera
  }
  return Eigen::VectorXd::Zero(fit.residual.size());
}

}  // namespace kinecal::detail
