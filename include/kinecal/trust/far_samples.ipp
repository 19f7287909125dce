// Samples with poses of their own that are far off as a whole.
//
// Such a sample hardly moves the fit of the others; and single corners at the border of a wide lens are often off by
// many times the noise, so that a fit without these views would be a worse one.  So a sample is judged by the root mean square of
// its residuals.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/geometry/median.hpp"
#include "kinecal/solve/linear_fit.hpp"

namespace kinecal::detail {

/// True for each sample whose residuals are four times those of a typical one.
/// @param sigma  noise of a weighted residual, by term
[[nodiscard]] inline std::vector<bool> far_samples(const AnyProblem& problem, const LinearFit& fit,
                                                   const std::vector<double>& sigma) {
  constexpr double kTimes = 4.0, kRounding = 1e-9;
  const auto samples = static_cast<std::size_t>(problem.num_samples());
  std::vector<double> sum(samples, 0.0), left(samples, 0.0), typical;
  for (const RowBlock& block : fit.blocks) {
    const auto s = static_cast<std::size_t>(block.sample);
    const double noise = std::max(kRounding, sigma[static_cast<std::size_t>(block.term)]);
    sum[s] += fit.residual.segment(block.first, block.size).squaredNorm() / (noise * noise);
    left[s] += static_cast<double>(block.size) - fit.used.segment(block.first, block.size).sum();
  }
  for (std::size_t s = 0; s < samples; ++s) {
    sum[s] = left[s] > 0.0 ? std::sqrt(sum[s] / left[s]) : 0.0;
    if (left[s] > 0.0) typical.push_back(sum[s]);
  }
  const double limit = typical.empty() ? HUGE_VAL : kTimes * std::max(1.0, median_of(typical));
  std::vector<bool> far(samples);
  for (std::size_t s = 0; s < samples; ++s) far[s] = sum[s] > limit;
  return far;
}

}  // namespace kinecal::detail
