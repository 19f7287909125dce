// New samples as rows, and the covariance of a calibration as columns.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal::detail {

/// B with C = B B^T.
[[nodiscard]] inline Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse = scale.unaryExpr([](double s) { return s > 0.0 ? 1.0 / s : 0.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse.asDiagonal() * covariance *
                                                              inverse.asDiagonal());
  constexpr double kRounding = 1e-14;
  const Eigen::VectorXd roots = solver.eigenvalues().unaryExpr(
      [](double lambda) { return lambda > kRounding ? std::sqrt(lambda) : 0.0; });
  const auto zeros = std::count(roots.begin(), roots.end(), 0.0);
  return scale.asDiagonal() *
         (solver.eigenvectors() * roots.asDiagonal()).rightCols(roots.size() - zeros);
}

/// The residuals of new samples, in standard deviations.
struct NewRows {
  LinearFit fit;  ///< derivatives by the free parameters themselves

  [[nodiscard]] double cost(const std::vector<bool>& used) const {
    double sum = 0.0;
    for (const RowBlock& block : fit.blocks) {
      if (!used[static_cast<std::size_t>(block.sample)]) continue;
      sum += fit.residual.segment(block.first, block.size).squaredNorm();
    }
    return sum;
  }
};

/// Sums over the rows of some samples.
struct DriftSums {
  Eigen::MatrixXd matrix;    ///< (free x free) J^T J
  Eigen::VectorXd gradient;  ///< (free) J^T r
};

/// The fall of X when something is freed.
struct DriftFall {
  double fall = 0.0;
  Eigen::Index rank = 0;  ///< of the freed parameters
};

/// A minimum of X.
struct DriftMinimum {
  Eigen::VectorXd z;        ///< (directions) where it is
  double statistic = 0.0;   ///< X
  Eigen::Index rank = 0;    ///< of the directions that cost nothing
  Eigen::MatrixXd inverse;  ///< (directions x directions) covariance of z
  NewRows rows;             ///< there
};

}  // namespace kinecal::detail
