// Compressing normal equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>

#include "kinecal/solve/compressed_cost.hpp"

namespace kinecal {

KINECAL_INLINE EquivalentResidual::EquivalentResidual(const NormalEquations& normal) {
  const Eigen::Index n = normal.gradient.size();
  const Eigen::VectorXd scale =
      normal.hessian.diagonal().unaryExpr([](double h) { return h > 0.0 ? std::sqrt(h) : 1.0; });
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * normal.hessian * scale.cwiseInverse().asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
  // H = D P^T L diag(d) L^T P D;  A = diag(sqrt d) L^T P D
  // A^-T g = diag(1/sqrt d) L^-1 P D^-1 g
  Eigen::MatrixXd rows = ldlt.matrixU();
  for (Eigen::Index k = n - 1; k >= 0; --k) {  // times P
    rows.col(k).swap(rows.col(ldlt.transpositionsP().coeff(k)));
  }
  Eigen::VectorXd projected =
      ldlt.transpositionsP() * scale.cwiseInverse().cwiseProduct(normal.gradient);
  ldlt.matrixL().solveInPlace(projected);
  residual.setZero(n + 1);
  jacobian.setZero(n + 1, n);
  constexpr double kNoCurvature = 1e-13;  // of a unit diagonal: rounding of the sums
  for (Eigen::Index i = 0; i < n; ++i) {
    const double d = ldlt.vectorD()(i);
    if (!(d > kNoCurvature)) continue;
    residual(i) = projected(i) / std::sqrt(d);
    jacobian.row(i) = std::sqrt(d) * rows.row(i).cwiseProduct(scale.transpose());
  }
  residual(n) = std::sqrt(std::max(0.0, 2.0 * normal.cost - residual.head(n).squaredNorm()));
}

KINECAL_INLINE CompressedCost::CompressedCost(AnyEvaluator& evaluator, Eigen::VectorXd values,
                                              Losses losses)
    : evaluator_(evaluator), free_(evaluator.free()), values_(std::move(values)), losses_(losses) {
  set_num_residuals(free_.size() + 1);
  mutable_parameter_block_sizes()->push_back(free_.size());
}

KINECAL_INLINE bool CompressedCost::Evaluate(double const* const* parameters, double* residuals,
                                             double** jacobians) const {
  for (int c = 0; c < free_.size(); ++c) {
    values_(free_.parameters()[static_cast<std::size_t>(c)]) = parameters[0][c];
  }
  const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
  const NormalEquations normal = evaluator_.normal_equations(
      {values_.data(), static_cast<std::size_t>(values_.size())}, derivatives, losses_);
  if (!std::isfinite(normal.cost)) return false;
  Eigen::Map<Eigen::VectorXd> r(residuals, free_.size() + 1);
  if (!derivatives) {  // only the cost is needed
    r.setZero();
    r(free_.size()) = std::sqrt(2.0 * normal.cost);
    return true;
  }
  const EquivalentResidual equivalent(normal);
  r = equivalent.residual;
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(jacobians[0], free_.size() + 1, free_.size()) = equivalent.jacobian;
  return true;
}

}  // namespace kinecal
