// Evaluating a problem once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/evaluate.hpp"

namespace kinecal {

KINECAL_INLINE std::optional<UndefinedResidual> evaluate(const AnyProblem& problem,
                                                         std::span<const double> values,
                                                         const FreeSet* free,
                                                         const RowVisitor& visit,
                                                         Linearization at) {
  const FreeSet none({}, problem.table().size());
  return problem.evaluator(free != nullptr ? *free : none)
      ->evaluate(values, free != nullptr, visit, at);
}

KINECAL_INLINE std::optional<UndefinedResidual> undefined_residual(const AnyProblem& problem,
                                                                   std::span<const double> values) {
  return evaluate(problem, values, nullptr, [](int, int, const TermResiduals&) {});
}

KINECAL_INLINE NormalEquations normal_equations(const AnyProblem& problem,
                                                std::span<const double> values, const FreeSet* free,
                                                Losses losses, int threads) {
  const FreeSet none({}, problem.table().size());
  return problem.evaluator(free != nullptr ? *free : none, threads)
      ->normal_equations(values, free != nullptr, losses);
}

}  // namespace kinecal
