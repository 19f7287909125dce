// The cost, its gradient and its Gauss-Newton Hessian, summed over all samples.
//
//   cost = 1/2 sum rho(|w r|^2)      gradient = sum rho' w^2 J^T r      hessian = sum rho' w^2 J^T
//   J
//
// over the features of all error blocks, each with its weight w and loss rho.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "kinecal/crate/problem.hpp"

namespace kinecal {

/// Which losses are used: those of the error blocks, or convex ones in their place.
enum class Losses { as_given, convex };

struct NormalEquations {
  double cost = 0.0;
  Eigen::VectorXd gradient;  ///< (parameters)
  Eigen::MatrixXd hessian;   ///< (parameters x parameters), symmetric

  /// Adds the residuals of one term in one sample.
  /// @param feature_size  number of residuals of one feature: the loss is applied to each feature
  /// @param repeats       how often they count
  void add(const TermResiduals& residuals, int feature_size, double weight, const Loss& loss_of,
           double repeats = 1.0) {
    const double w2 = weight * weight;
    const bool derivatives = residuals.jacobian.rows() > 0;
    Eigen::VectorXd factors(residuals.residual.size());
    for (Eigen::Index row = 0; row < residuals.residual.size(); row += feature_size) {
      const double squared = residuals.residual.segment(row, feature_size).squaredNorm();
      const Loss::Value loss = loss_of(w2 * squared);
      cost += 0.5 * repeats * loss.rho;
      factors.segment(row, feature_size).setConstant(repeats * loss.derivative * w2);
    }
    if (!derivatives) return;
    const Eigen::MatrixXd weighted = factors.asDiagonal() * residuals.jacobian;
    gradient.noalias() += weighted.transpose() * residuals.residual;
    hessian.noalias() += weighted.transpose() * residuals.jacobian;
  }
};

/// Sums the normal equations of a problem.
/// @param values     of all parameters of the problem's table
/// @param free       the parameters to differentiate by; nullptr: the cost only
/// @param undefined  where a residual is not defined; then the sums are incomplete
[[nodiscard]] inline NormalEquations normal_equations(const Problem& problem,
                                                      std::span<const double> values,
                                                      const FreeSet* free,
                                                      std::optional<UndefinedResidual>& undefined,
                                                      Losses losses = Losses::as_given) {
  const auto loss_of = [&](const TermOptions& options) {
    return losses == Losses::convex ? options.loss.convex() : options.loss;
  };
  NormalEquations sum;
  const int n = free != nullptr ? free->size() : 0;
  sum.gradient.setZero(n);
  sum.hessian.setZero(n, n);
  undefined = problem.evaluate(values, free, [&](int t, int, const TermResiduals& residuals) {
    const Term& term = *problem.terms()[static_cast<std::size_t>(t)];
    const TermOptions& options = term.options();
    sum.add(residuals, term.feature_size(), options.weight, loss_of(options));
  });
  TermResiduals residuals;
  for (const PriorTerm& prior : problem.priors()) {
    prior.evaluate(problem.table(), values, free, residuals);
    sum.add(residuals, Prior::kRows, prior.options.weight, loss_of(prior.options),
            problem.num_samples());
  }
  return sum;
}

}  // namespace kinecal
