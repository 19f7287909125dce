// The normal equations: cost, gradient and Gauss-Newton Hessian, summed over samples.
//
//   cost = 1/2 sum rho(|w r|^2)    gradient = sum rho' w^2 J^T r    hessian = sum rho' w^2 J^T J
//
// over the features of all error blocks, each with its weight w and loss rho.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kinecal {

/// Which losses an evaluation uses.
enum class Losses {
  as_given,  ///< those of the error blocks
  convex     ///< their convex counterparts: see Loss::convex()
};

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

}  // namespace kinecal
