// The uncompressed path: one Ceres residual block per feature, the usual way to use Ceres.
//
// Cost, gradient and steps are the same; the time grows with the number of samples.  Use it for
// comparison, or to add your own residual blocks to the same Ceres problem.  All features are
// evaluated at once before Ceres asks for the first of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <Eigen/Core>
#include <memory>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/stack.hpp"

namespace kinecal {

/// A loss of errors/loss.hpp as a Ceres loss function.
class CeresLoss final : public ceres::LossFunction {
 public:
  /// Takes a copy of the loss.
  explicit CeresLoss(const Loss& loss) : loss_(loss) {}
  /// Writes rho, its derivative, and zero: the second derivative is never positive, and Ceres
  /// ignores negative ones.
  void Evaluate(double squared, double* rho) const override;

 private:
  Loss loss_;
};

/// Residuals and Jacobian of all features and priors at Ceres' current point.
class StackedResiduals final : public ceres::EvaluationCallback {
 public:
  /// @param values  of all parameters of the problem's table; the free ones are replaced
  /// @param x       the free parameters, owned by the caller; Ceres changes them
  StackedResiduals(const AnyProblem& problem, const FreeSet& free, Eigen::VectorXd values,
                   const double* x, Losses losses);

  /// Evaluates all features at Ceres' current point; called by Ceres.  Always with derivatives: a trial step to
  /// where one is undefined is refused.
  void PrepareForEvaluation(bool, bool) override;
  /// True if all residuals and derivatives are defined at the current point.  Ceres logs a start where they are not.
  [[nodiscard]] bool is_defined() {
    PrepareForEvaluation(true, true);
    return defined_;
  }

  /// Adds a residual block for each feature and prior.
  void add_to(ceres::Problem& problem, double* x);

 private:
  class Rows;

  const AnyProblem& problem_;
  FreeSet free_;
  Eigen::VectorXd values_;
  const double* x_;
  Losses losses_;
  std::unique_ptr<AnyEvaluator> evaluator_;
  Stack rows_;
  bool evaluated_ = false;  ///< at values_
  bool defined_ = false;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/stacked_cost.ipp"
#endif
