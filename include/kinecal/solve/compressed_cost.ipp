// Compressing normal equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Cholesky>
#include <cmath>

#include "kinecal/geometry/ldlt.hpp"
#include "kinecal/solve/compressed_cost.hpp"

namespace kinecal::detail {

/// A and A^-T g of a regular H = D P^T L diag(d) L^T P D:  A = diag(sqrt d) L^T P D.
/// @param gradient  D^-1 g
/// @param scale     D
inline void set_regular(const Eigen::LDLT<Eigen::MatrixXd>& ldlt, const Eigen::VectorXd& gradient,
                        const Eigen::VectorXd& scale, EquivalentResidual& all) {
  const Eigen::Index n = gradient.size();
  Eigen::MatrixXd rows = ldlt.matrixU();
  for (Eigen::Index k = n - 1; k >= 0; --k) {  // times P
    rows.col(k).swap(rows.col(ldlt.transpositionsP().coeff(k)));
  }
  Eigen::VectorXd projected = ldlt.transpositionsP() * gradient;
  ldlt.matrixL().solveInPlace(projected);
  const Eigen::VectorXd roots = ldlt.vectorD().cwiseSqrt();
  all.residual.head(n) = projected.cwiseQuotient(roots);
  all.jacobian.topRows(n) = rows * scale.asDiagonal();
  all.jacobian.topRows(n) = roots.asDiagonal() * all.jacobian.topRows(n);
}

/// The same of any H, with the largest pivot first and zeros where no curvature is left.
/// @param left  D^-1 H D^-1, which becomes D^-1 (H - A^T A) D^-1
inline void set_singular(Eigen::MatrixXd left, Eigen::VectorXd gradient,
                         const Eigen::VectorXd& scale, EquivalentResidual& all) {
  for (Eigen::Index k = 0; k < gradient.size(); ++k) {
    Eigen::Index pivot = 0;
    const double d = left.diagonal().maxCoeff(&pivot);
    if (!(d > kNoCurvature)) break;
    const Eigen::VectorXd row = left.col(pivot) / std::sqrt(d);
    all.residual(k) = gradient(pivot) / std::sqrt(d);
    all.jacobian.row(k) = row.cwiseProduct(scale);
    left.noalias() -= row * row.transpose();
    gradient -= all.residual(k) * row;
    left.row(pivot).setZero();
    left.col(pivot).setZero();
    gradient(pivot) = 0.0;
  }
}

KINECAL_INLINE EquivalentResidual::EquivalentResidual(const NormalEquations& normal) {
  const Eigen::Index n = normal.gradient.size();
  // A shorter column is rounding, as of the turn of a frame about the only point in it.  Scaled to one, it would be a
  // direction in which the cost seems to fall.
  constexpr double kNoEffect = 1e-13;  // of the longest column
  const double least = n > 0 ? kNoEffect * kNoEffect * normal.hessian.diagonal().maxCoeff() : 0.0;
  const Eigen::VectorXd scale = normal.hessian.diagonal().unaryExpr(
      [least](double h) { return h > least ? std::sqrt(h) : 1.0; });
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * normal.hessian * scale.cwiseInverse().asDiagonal();
  const Eigen::VectorXd gradient = scale.cwiseInverse().cwiseProduct(normal.gradient);
  residual.setZero(n + 1);
  jacobian.setZero(n + 1, n);
  const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
  if (ldlt.vectorD().minCoeff() > kNoCurvature) {
    set_regular(ldlt, gradient, scale, *this);
  } else {
    set_singular(scaled, gradient, scale, *this);
  }
  residual(n) = std::sqrt(std::max(0.0, 2.0 * normal.cost - residual.head(n).squaredNorm()));
}

KINECAL_INLINE GaussNewtonStep gauss_newton_step(const EquivalentResidual& at) {
  const Eigen::Index n = at.jacobian.cols();
  const auto rows = at.jacobian.topRows(n);
  const auto residual = at.residual.head(n);
  const Eigen::VectorXd scale = rows.colwise().norm().transpose().unaryExpr(
      [](double length) { return length > 0.0 ? length : 1.0; });
  const Eigen::MatrixXd scaled = rows * scale.cwiseInverse().asDiagonal();
  Eigen::MatrixXd hessian = scaled.transpose() * scaled;
  hessian.diagonal().array() += 10.0 * kNoCurvature;
  const Eigen::VectorXd step =
      Ldlt(hessian).solve(Eigen::VectorXd(-(scaled.transpose() * residual)));
  return {step.cwiseQuotient(scale), 0.5 * (residual + scaled * step).squaredNorm()};
}

KINECAL_INLINE CompressedCost::CompressedCost(AnyEvaluator& evaluator, Eigen::VectorXd values,
                                              Losses losses, Blocks blocks)
    : evaluator_(evaluator),
      free_(evaluator.free()),
      values_(std::move(values)),
      losses_(losses),
      blocks_(std::move(blocks)) {
  set_num_residuals(free_.size() + 1);
  if (blocks_.empty()) {
    std::vector<int>& all = blocks_.emplace_back();
    for (int c = 0; c < free_.size(); ++c) all.push_back(c);
  }
  for (const std::vector<int>& columns : blocks_) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(columns.size()));
  }
}

KINECAL_INLINE double CompressedCost::cost_at(const Eigen::VectorXd& x) const {
  Eigen::VectorXd values = values_;
  values(free_.parameters()) = x;
  ++evaluations_;
  return evaluator_
      .normal_equations({values.data(), static_cast<std::size_t>(values.size())}, false, losses_)
      .cost;
}

KINECAL_INLINE bool CompressedCost::Evaluate(double const* const* parameters, double* residuals,
                                             double** jacobians) const {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    for (std::size_t k = 0; k < blocks_[b].size(); ++k) {
      const auto column = static_cast<std::size_t>(blocks_[b][k]);
      values_(free_.parameters()[column]) = parameters[b][k];
    }
  }
  if (!last_ || values_ != last_values_) {
    ++evaluations_;
    const NormalEquations normal = evaluator_.normal_equations(
        {values_.data(), static_cast<std::size_t>(values_.size())}, true, losses_);
    last_.emplace(normal);
    last_values_ = values_;
    is_defined_ =
        std::isfinite(normal.cost) && last_->residual.allFinite() && last_->jacobian.allFinite();
  }
  if (!is_defined_) return false;
  Eigen::Map<Eigen::VectorXd>(residuals, free_.size() + 1) = last_->residual;
  if (jacobians == nullptr) return true;
  promised_decrease_ = 0.5 * last_->residual.head(free_.size()).squaredNorm();
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    if (jacobians[b] == nullptr) continue;
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<RowMajor>(jacobians[b], free_.size() + 1, std::ssize(blocks_[b])) =
        last_->jacobian(Eigen::all, blocks_[b]);
  }
  return true;
}

KINECAL_INLINE bool CompressedCost::is_defined_at(const double* x) const {
  Eigen::VectorXd residual(free_.size() + 1);
  return Evaluate(&x, residual.data(), nullptr);
}

}  // namespace kinecal::detail
