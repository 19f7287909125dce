// What residuals change by if samples said something else: other joint positions, other points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>

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
[[nodiscard]] Eigen::VectorXd sample_slopes(const FittedSamples& fitted,
                                            const std::function<void(Sample&)>& move, double step);

}  // namespace kinecal::detail
