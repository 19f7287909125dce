// The normal equations: cost, gradient and Gauss-Newton Hessian, summed over samples.
//
//   cost = 1/2 sum rho(|w r|^2)    gradient = sum rho' w^2 J^T r    hessian = sum rho' w^2 J^T J
//
// over the features of all error blocks, each with its weight w and loss rho.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "kinecal/problem/any_term.hpp"

namespace kinecal {

/// Cost, gradient and Gauss-Newton Hessian.
struct NormalEquations {
  double cost = 0.0;         ///< not finite if a residual is undefined
  Eigen::VectorXd gradient;  ///< (parameters); empty if only the cost was asked for
  Eigen::MatrixXd hessian;   ///< (parameters x parameters), symmetric

  /// All zero.
  explicit NormalEquations(int parameters)
      : gradient(Eigen::VectorXd::Zero(parameters)),
        hessian(Eigen::MatrixXd::Zero(parameters, parameters)) {}

  /// Adds those of other samples.
  NormalEquations& operator+=(const NormalEquations& other) {
    cost += other.cost;
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
};

/// Adds the weighted residuals of a prior to normal equations, once for each sample.  Each residual
/// depends on one parameter, so J^T J is diagonal.
inline void add_prior(NormalEquations& total, const TermOptions& options,
                      const TermResiduals& residuals, int samples, Losses losses) {
  const double w2 = options.weight * options.weight;
  const auto loss = options.loss_for(losses)(w2 * residuals.residual.squaredNorm());
  total.cost += 0.5 * samples * loss.rho;
  if (residuals.jacobian.cols() == 0) return;
  const double factor = samples * w2 * loss.derivative;
  for (Eigen::Index row = 0; row < residuals.jacobian.rows(); ++row) {
    for (Eigen::Index column = 0; column < residuals.jacobian.cols(); ++column) {
      const double derivative = residuals.jacobian(row, column);
      total.gradient(column) += factor * derivative * residuals.residual(row);
      total.hessian(column, column) += factor * derivative * derivative;
    }
  }
}

}  // namespace kinecal
