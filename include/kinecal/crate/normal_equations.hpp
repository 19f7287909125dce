// The cost, its gradient and its Gauss-Newton Hessian, summed over samples.
//
//   cost = 1/2 sum rho(|w r|^2)    gradient = sum rho' w^2 J^T r    hessian = sum rho' w^2 J^T J
//
// over the features of all error blocks, each with its weight w and loss rho.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace kinecal {

/// Which losses are used: those of the error blocks, or convex ones in their place.
enum class Losses { as_given, convex };

struct NormalEquations {
  double cost = 0.0;         ///< not finite where a residual is not defined
  Eigen::VectorXd gradient;  ///< (parameters); empty if only the cost was asked for
  Eigen::MatrixXd hessian;   ///< (parameters x parameters), symmetric

  explicit NormalEquations(int parameters)
      : gradient(Eigen::VectorXd::Zero(parameters)),
        hessian(Eigen::MatrixXd::Zero(parameters, parameters)) {}

  NormalEquations& operator+=(const NormalEquations& other) {
    cost += other.cost;
    gradient += other.gradient;
    hessian += other.hessian;
    return *this;
  }
};

}  // namespace kinecal
