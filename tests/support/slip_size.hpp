// How much a slip of a joint shows in samples.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "kinecal/trust/noise/noise.hpp"
#include "kinecal/trust/noise/sample_slopes.hpp"

namespace kinecal::test {

/// How far the features of samples move if a joint slips: the root of the mean squared distance, in standard
/// deviations of the first error block's noise.
inline double slip_size(const AnyProblem& problem, ParameterValues values,
                        const std::vector<Sample>& samples, const BlockNoise& noise,
                        const std::string& joint, double slip) {
  const FreeSet free({}, problem.table().size());
  const auto evaluator = problem.evaluator(free, 1);
  const LinearFit fit = linear_fit(*evaluator, values, {}, false);
  const Eigen::VectorXd moved = detail::sample_slopes(
      {problem, free, fit, values, samples},
      [&](Sample& sample) { sample.add_to_position(joint, slip); }, 1.0);
  const double features = static_cast<double>(moved.size()) / noise.components;
  return std::sqrt(moved.squaredNorm() / features) / noise.weighted();
}

}  // namespace kinecal::test
