// Stacking residuals for Ceres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/solve/stacked_cost.hpp"

namespace kinecal {

KINECAL_INLINE void CeresLoss::Evaluate(double squared, double* rho) const {
  const auto value = loss_(squared);
  rho[0] = value.rho;
  rho[1] = value.derivative;
  rho[2] = 0.0;
}

/// Some rows of the stack.
class StackedResiduals::Rows final : public ceres::CostFunction {
 public:
  Rows(const StackedResiduals& stack, Eigen::Index row, int size) : stack_(stack), row_(row) {
    set_num_residuals(size);
    mutable_parameter_block_sizes()->push_back(stack.free_.size());
  }
  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!stack_.defined_) return false;
    const int size = num_residuals();
    Eigen::Map<Eigen::VectorXd>(residuals, size) = stack_.rows_.residual.segment(row_, size);
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Stack::RowMajor>(jacobians[0], size, stack_.free_.size()) =
          stack_.rows_.jacobian.middleRows(row_, size);
    }
    return true;
  }

 private:
  const StackedResiduals& stack_;
  Eigen::Index row_;
};

KINECAL_INLINE StackedResiduals::StackedResiduals(const AnyProblem& problem, const FreeSet& free,
                                                  Eigen::VectorXd values, const double* x,
                                                  Losses losses)
    : problem_(problem),
      free_(free),
      values_(std::move(values)),
      x_(x),
      losses_(losses),
      evaluator_(problem.evaluator(free, 1)) {
  rows_.residual.resize(problem.num_residuals());
  rows_.jacobian.resize(problem.num_residuals(), free.size());
}

KINECAL_INLINE void StackedResiduals::PrepareForEvaluation(bool, bool) {
  for (int c = 0; c < free_.size(); ++c) {
    double& value = values_(free_.parameters()[static_cast<std::size_t>(c)]);
    evaluated_ = evaluated_ && value == x_[c];
    value = x_[c];
  }
  if (evaluated_) return;
  const ParameterValues values(values_.data(), static_cast<std::size_t>(values_.size()));
  defined_ = !detail::stack_rows(*evaluator_, values, true, 1.0, rows_);
  evaluated_ = true;
}

KINECAL_INLINE void StackedResiduals::add_to(ceres::Problem& problem, double* x) {
  Eigen::Index row = 0;
  const auto add = [&](int size, const TermOptions& options, double repeats) {
    const Loss loss = options.loss_for(losses_);
    ceres::LossFunction* robust =
        loss.type == LossType::none ? nullptr : new CeresLoss(loss);  // Ceres takes it
    if (repeats != 1.0) {
      robust = new ceres::ScaledLoss(robust, repeats, ceres::TAKE_OWNERSHIP);
    }
    problem.AddResidualBlock(new Rows(*this, row, size), robust, x);
    row += size;
  };
  const ParameterValues values(values_.data(), static_cast<std::size_t>(values_.size()));
  (void)evaluator_->evaluate(values, false, [&](int t, int, const TermResiduals& of_term) {
    const Term& term = problem_.term(t);
    const int features = static_cast<int>(of_term.residual.size()) / term.feature_size;
    for (int i = 0; i < features; ++i) add(term.feature_size, term.options, 1.0);
  });
  for (const PriorTerm& prior : problem_.priors()) {
    add(Prior::kRows, prior.options, problem_.num_samples());
  }
}

}  // namespace kinecal
