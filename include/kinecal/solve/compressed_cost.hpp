// The compressed cost: all samples as one Ceres residual of parameters + 1 rows.
//
// Least squares meets the samples only through H = J^T J, g = J^T r and the cost c.  With H = A^T
// A,
//
//   r' = ( A^-T g, sqrt(2 c - |A^-T g|^2) )      J' = ( A, 0 )
//
// has the same cost, gradient and Gauss-Newton Hessian as the stacked residuals of all samples, so
// Ceres takes the same steps on a problem whose size does not grow with their number.  The root is
// of a number that is never negative: |A^-T g|^2 is the part of the weighted residual within the
// range of J, and robust losses satisfy rho' s <= rho (errors/loss.hpp).
//
// A comes from a pivoted LDL^T of H, scaled to a unit diagonal: H may be singular, as it is when
// parameters cannot be told apart; a direction without curvature gets a row of zeros.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Cholesky>

#include "kinecal/crate/evaluate.hpp"

namespace kinecal {

/// A residual and Jacobian equivalent to normal equations.
struct EquivalentResidual {
  Eigen::VectorXd residual;  ///< (parameters + 1)
  Eigen::MatrixXd jacobian;  ///< (parameters + 1 x parameters)

  explicit EquivalentResidual(const NormalEquations& normal) {
    const Eigen::Index n = normal.gradient.size();
    const Eigen::VectorXd scale =
        normal.hessian.diagonal().unaryExpr([](double h) { return h > 0.0 ? std::sqrt(h) : 1.0; });
    const Eigen::MatrixXd scaled =
        scale.cwiseInverse().asDiagonal() * normal.hessian * scale.cwiseInverse().asDiagonal();
    const Eigen::LDLT<Eigen::MatrixXd> ldlt(scaled);
    // H = D P^T L diag(d) L^T P D;  A = diag(sqrt d) L^T P D;  A^-T g = diag(1/sqrt d) L^-1 P D^-1
    // g
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
};

/// The whole problem as one Ceres cost function over the free parameters.
template <class S>
class CompressedCost final : public ceres::CostFunction {
 public:
  /// @param evaluator  of the problem and its free parameters; outlives the cost
  /// @param values     of all parameters of the problem's table; the free ones are replaced
  CompressedCost(Evaluator<S>& evaluator, Eigen::VectorXd values, Losses losses = Losses::as_given)
      : evaluator_(evaluator),
        free_(evaluator.free()),
        values_(std::move(values)),
        losses_(losses) {
    set_num_residuals(free_.size() + 1);
    mutable_parameter_block_sizes()->push_back(free_.size());
  }

  /// False where a residual is not defined: Ceres then takes a shorter step.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    for (int c = 0; c < free_.size(); ++c) {
      values_(free_.parameters()[static_cast<std::size_t>(c)]) = parameters[0][c];
    }
    const bool derivatives = jacobians != nullptr && jacobians[0] != nullptr;
    const NormalEquations normal = evaluator_.normal_equations(
        {values_.data(), static_cast<std::size_t>(values_.size())}, derivatives, losses_);
    if (!std::isfinite(normal.cost)) return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, free_.size() + 1);
    if (!derivatives) {  // the cost is all that is asked for
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

 private:
  // Ceres evaluates one cost function on one thread at a time.
  Evaluator<S>& evaluator_;
  const FreeSet& free_;
  mutable Eigen::VectorXd values_;
  Losses losses_;
};

}  // namespace kinecal
