// A whole problem as one residual vector and one Jacobian: for your own solver or statistics.
//
//   const Stack s = stack(problem, free, values);
//   const Eigen::VectorXd step = -s.jacobian.colPivHouseholderQr().solve(s.residual);
//
// Use it if the problem fits in memory; AnyEvaluator::normal_equations() sums the same rows without
// storing them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// Weighted residuals of a problem and their derivatives.
struct Stack {
  /// Rows as the evaluation writes them.
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// (residuals) feature weight times residual: term by term, sample by sample, then the priors.
  Eigen::VectorXd residual;
  RowMajor jacobian;  ///< (residuals x free parameters) derivatives of these

  /// (free x free) covariance of the free parameters: (J^T J)^-1.  Valid if weights are one over
  /// standard deviations; if you know only their ratios, multiply by residual.squaredNorm() /
  /// (residuals - free).
  /// @returns  nullopt if the samples do not determine all of them
  [[nodiscard]] std::optional<Eigen::MatrixXd> covariance() const;
};

/// Stacks all residuals of a problem.  Losses are not applied.
/// @param free    the columns of the Jacobian
/// @param values  of all parameters of the problem's table
/// @returns  residuals whose squares add up to twice the cost without losses.  A prior counts once
///           per sample: its rows carry the square root of the number of samples
/// @throws std::domain_error      if a residual is undefined, such as that of a point behind a
///                                camera; with the error block and the sample
/// @throws std::invalid_argument  if a free parameter does not belong to the problem, or if the
///                                number of values is not that of the table's parameters
[[nodiscard]] Stack stack(const AnyProblem& problem, const FreeSet& free, ParameterValues values);

namespace detail {
/// Writes weighted rows into a Stack of the problem's size.
/// @param prior_factor  further factor of the priors' rows
/// @returns  the first undefined residual, if any; then the rows are not valid
std::optional<UndefinedResidual> stack_rows(AnyEvaluator& evaluator, ParameterValues values,
                                            bool jacobians, double prior_factor, Stack& out);
}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/stack.ipp"
#endif
