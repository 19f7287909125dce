// The compressed cost: all samples as one Ceres residual of (parameters + 1) rows.
//
// Least squares sees the samples only through H = J^T J, g = J^T r and the cost c.  With
// H = A^T A,
//
//   r' = ( A^-T g, sqrt(2 c - |A^-T g|^2) )      J' = ( A, 0 )
//
// has the same cost, gradient and Gauss-Newton Hessian as the stacked residuals of all samples.  So
// Ceres takes the same steps, on a problem whose size does not grow with their number.  The number
// under the root is never negative: |A^-T g|^2 is the part of the weighted residual in the range of
// J, and robust losses satisfy rho' s <= rho (errors/loss.hpp).
//
// A comes from an LDL^T of H, scaled to a unit diagonal.  H is singular if the samples cannot separate some parameters.
// Eigen's LDL^T takes its pivots by the diagonal of H itself, so it divides by rounding in between, and A^T r' is not the
// gradient.  Then A comes from a Cholesky decomposition with the largest pivot first; directions without curvature get
// rows of zeros.
// Source: Higham, Analysis of the Cholesky Decomposition of a Semi-definite Matrix, 1990.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal::detail {

/// Of normal equations with a unit diagonal: rounding of the sums.
inline constexpr double kNoCurvature = 1e-13;

/// A residual and Jacobian equivalent to normal equations.
struct EquivalentResidual {
  Eigen::VectorXd residual;  ///< (parameters + 1)
  Eigen::MatrixXd jacobian;  ///< (parameters + 1 x parameters)

  /// Computes both from normal equations; needs derivatives.
  explicit EquivalentResidual(const NormalEquations& normal);
};

/// A Gauss-Newton step.
struct GaussNewtonStep {
  Eigen::VectorXd step;  ///< (parameters)
  double left = 0.0;     ///< decrease of the cost that the linear model still promises after it
};

/// The Gauss-Newton step of an equivalent residual.  It does not move along directions without curvature.
[[nodiscard]] GaussNewtonStep gauss_newton_step(const EquivalentResidual& at);

/// The whole problem as one Ceres cost function over the free parameters.
///
/// Ceres asks for the cost of a step first, and for the Jacobian if it accepts the step, as it
/// mostly does.  Both are computed at once and kept; so a run that starts where another ended skips
/// its first evaluation.
class CompressedCost final : public ceres::CostFunction {
 public:
  /// Columns of the free set by Ceres' parameter block.
  using Blocks = std::vector<std::vector<int>>;

  /// @param evaluator  of the problem and its free parameters; must outlive the cost
  /// @param values     of all parameters of the problem's table; the free ones are replaced
  /// @param blocks     each column once; empty: one block of all
  CompressedCost(AnyEvaluator& evaluator, Eigen::VectorXd values, Losses losses = Losses::as_given,
                 Blocks blocks = {});

  /// Returns false where a residual or a derivative is undefined: Ceres then takes a shorter step.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;
  /// True if everything is defined.  Ceres logs a start that is not.
  /// @param x  (parameters) the free ones, in one block
  [[nodiscard]] bool is_defined_at(const double* x) const;

  /// The decrease of the cost that a Gauss-Newton step predicts where the Jacobian was last
  /// evaluated:  half the squared Newton decrement.
  [[nodiscard]] double promised_decrease() const { return promised_decrease_; }
  /// The Gauss-Newton step from where the samples were last evaluated.
  [[nodiscard]] GaussNewtonStep gauss_newton() const { return gauss_newton_step(*last_); }
  /// The cost, without derivatives.  Not finite where a residual is undefined.
  /// @param x  (parameters) the free ones
  [[nodiscard]] double cost_at(const Eigen::VectorXd& x) const;
  /// How often all samples were evaluated.
  [[nodiscard]] int evaluations() const { return evaluations_; }

 private:
  // Ceres evaluates one cost function on one thread at a time.
  AnyEvaluator& evaluator_;
  const FreeSet& free_;
  mutable Eigen::VectorXd values_;
  mutable double promised_decrease_ = std::numeric_limits<double>::infinity();
  mutable int evaluations_ = 0;
  mutable std::optional<EquivalentResidual> last_;
  mutable Eigen::VectorXd last_values_;  ///< the values of `last_`
  mutable bool is_defined_ = false;      ///< no number of `last_` is infinite or NaN
  Losses losses_;
  Blocks blocks_;
};

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/compressed_cost.ipp"
#endif
