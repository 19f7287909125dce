// Stacking the residuals of a problem.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <stdexcept>

#include "kinecal/geometry/eigenpairs.hpp"
#include "kinecal/solve/stack.hpp"

namespace kinecal {

KINECAL_INLINE std::optional<UndefinedResidual> detail::stack_rows(AnyEvaluator& evaluator,
                                                                   ParameterValues values,
                                                                   bool jacobians,
                                                                   double prior_factor,
                                                                   Stack& out) {
  const AnyProblem& problem = evaluator.problem();
  Eigen::Index row = 0;
  const auto append = [&](double weight, const TermResiduals& of_term) {
    const Eigen::Index rows = of_term.residual.size();
    const Eigen::VectorXd weights = weight * of_term.factor;
    out.residual.segment(row, rows) = weights.cwiseProduct(of_term.residual);
    if (jacobians) out.jacobian.middleRows(row, rows) = weights.asDiagonal() * of_term.jacobian;
    row += rows;
  };
  auto undefined = evaluator.evaluate(values, jacobians, [&](int t, int, const auto& of_term) {
    append(problem.term(t).weight, of_term);
  });
  TermResiduals of_prior;
  for (const PriorTerm& prior : problem.priors()) {
    prior.evaluate(problem.table(), values, jacobians ? &evaluator.free() : nullptr, of_prior);
    append(prior_factor * prior.options.weight(), of_prior);
  }
  return undefined;
}

KINECAL_INLINE std::optional<Eigen::MatrixXd> Stack::covariance() const {
  constexpr double kLeast = 1e-14;  // eigenvalue, of columns of length one
  const Eigen::VectorXd lengths = jacobian.colwise().norm();
  if (!(lengths.array() > 0.0).all()) return std::nullopt;
  const Eigen::VectorXd scale = lengths.cwiseInverse();
  const Eigen::MatrixXd columns = jacobian * scale.asDiagonal();
  const detail::Eigenpairs pairs = detail::eigenpairs(columns.transpose() * columns);
  if (!(pairs.values(0) > kLeast * static_cast<double>(columns.cols()))) {
    return std::nullopt;
  }
  const Eigen::MatrixXd v = scale.asDiagonal() * pairs.vectors;
  return v * pairs.values.cwiseInverse().asDiagonal() * v.transpose();
}

KINECAL_INLINE Stack stack(const AnyProblem& problem, const FreeSet& free, ParameterValues values) {
  const auto evaluator = problem.evaluator(free, 1);
  Stack all;
  all.residual.resize(problem.num_residuals());
  all.jacobian.resize(problem.num_residuals(), free.size());
  const auto undefined =
      detail::stack_rows(*evaluator, values, true, std::sqrt(double(problem.num_samples())), all);
  if (undefined) {
    throw std::domain_error(undefined->source + ": error block '" + undefined->term +
                            "': the residual is not defined at these values");
  }
  return all;
}

}  // namespace kinecal
