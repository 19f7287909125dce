// Evaluating a problem once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/problem.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// Evaluates all residuals once: see AnyEvaluator::evaluate().
/// @param free  the columns of the Jacobian; nullptr: residuals only
[[nodiscard]] std::optional<UndefinedResidual> evaluate(const AnyProblem& problem,
                                                        std::span<const double> values,
                                                        const FreeSet* free,
                                                        const RowVisitor& visit,
                                                        Linearization at = Linearization::measured);

/// The first residual that is undefined for these values, if any.
[[nodiscard]] std::optional<UndefinedResidual> undefined_residual(const AnyProblem& problem,
                                                                  std::span<const double> values);

/// The normal equations once: see AnyEvaluator::normal_equations().
/// @param free  the parameters to differentiate by; nullptr: the cost only
[[nodiscard]] NormalEquations normal_equations(const AnyProblem& problem,
                                               std::span<const double> values, const FreeSet* free,
                                               Losses losses = Losses::as_given, int threads = 1);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/evaluation/evaluate.ipp"
#endif
