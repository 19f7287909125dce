// Definition of solve().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <utility>

#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/solve_with.ipp"

namespace kinecal {

KINECAL_INLINE StepResult solve(const AnyProblem& problem, const FreeSet& free,
                                Eigen::VectorXd& values, const SolveOptions& options) {
  if (free.size() == 0) throw std::invalid_argument("nothing is free: there is nothing to solve");
  StepResult result;
  result.num_parameters = free.size();
  // Priors count once for each sample.
  result.num_residuals = problem.num_residuals() + static_cast<int>(problem.priors().size()) *
                                                       Prior::kRows * (problem.num_samples() - 1);
  result.form = options.form;
  result.samples = problem.num_samples();
  const auto evaluator_of = [&](const FreeSet& columns) {
    return problem.evaluator(columns, options.threads);
  };
  return detail::solve_with(evaluator_of, free, values, options, std::move(result));
}

}  // namespace kinecal
