// The uncompressed path: every feature a residual block of its own, as Ceres is used elsewhere.
//
// Slower, as it grows with the number of samples, and the same cost, gradient and steps; it is here
// for comparison, and to stand beside residual blocks of other origin in one Ceres problem.  All
// features are evaluated at once before Ceres asks for the first of them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include "kinecal/crate/evaluate.hpp"

namespace kinecal {

/// A loss of errors/loss.hpp as Ceres takes it.
class CeresLoss final : public ceres::LossFunction {
 public:
  explicit CeresLoss(const Loss& loss) : loss_(loss) {}
  /// The second derivative is never positive; Ceres uses no others.
  void Evaluate(double squared, double* rho) const override {
    const auto value = loss_(squared);
    rho[0] = value.rho;
    rho[1] = value.derivative;
    rho[2] = 0.0;
  }

 private:
  Loss loss_;
};

/// Residuals and Jacobian of all features and priors at the point where Ceres is.
template <class S>
class StackedResiduals final : public ceres::EvaluationCallback {
 public:
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// @param values  of all parameters of the problem's table; the free ones are replaced
  /// @param x       the free parameters, kept by the caller; Ceres changes them
  StackedResiduals(const BasicProblem<S>& problem, const FreeSet& free, Eigen::VectorXd values,
                   const double* x, Losses losses)
      : problem_(problem),
        free_(free),
        values_(std::move(values)),
        x_(x),
        losses_(losses),
        evaluator_(problem, free) {
    residual_.resize(problem.num_residuals());
    jacobian_.resize(problem.num_residuals(), free.size());
  }

  void PrepareForEvaluation(bool jacobians, bool) override {
    for (int c = 0; c < free_.size(); ++c) {
      values_(free_.parameters()[static_cast<std::size_t>(c)]) = x_[c];
    }
    const std::span<const double> values(values_.data(), static_cast<std::size_t>(values_.size()));
    Eigen::Index row = 0;
    const auto stack = [&](double weight, const TermResiduals& of_term) {
      const Eigen::Index rows = of_term.residual.size();
      residual_.segment(row, rows) = weight * of_term.residual;
      if (jacobians) jacobian_.middleRows(row, rows) = weight * of_term.jacobian;
      row += rows;
    };
    const FreeSet* free = jacobians ? &free_ : nullptr;
    defined_ = !evaluator_.evaluate(values, jacobians, [&](int t, int, const auto& of_term) {
      stack(problem_.terms()[static_cast<std::size_t>(t)]->options().weight, of_term);
    });
    TermResiduals of_prior;
    for (const PriorTerm& prior : problem_.priors()) {
      prior.evaluate(problem_.table(), values, free, of_prior);
      stack(prior.options.weight, of_prior);
    }
  }

  /// Adds a residual block for each feature and prior.
  void add_to(ceres::Problem& problem, double* x) {
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
    const std::span<const double> values(values_.data(), static_cast<std::size_t>(values_.size()));
    (void)evaluator_.evaluate(values, false, [&](int t, int, const TermResiduals& of_term) {
      const Term<S>& term = *problem_.terms()[static_cast<std::size_t>(t)];
      const int features = static_cast<int>(of_term.residual.size()) / term.feature_size();
      for (int i = 0; i < features; ++i) add(term.feature_size(), term.options(), 1.0);
    });
    for (const PriorTerm& prior : problem_.priors()) {
      add(Prior::kRows, prior.options, problem_.num_samples());
    }
  }

 private:
  /// Some rows of the stack.
  class Rows final : public ceres::CostFunction {
   public:
    Rows(const StackedResiduals& stack, Eigen::Index row, int size) : stack_(stack), row_(row) {
      set_num_residuals(size);
      mutable_parameter_block_sizes()->push_back(stack.free_.size());
    }
    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
      if (!stack_.defined_) return false;
      const int size = num_residuals();
      Eigen::Map<Eigen::VectorXd>(residuals, size) = stack_.residual_.segment(row_, size);
      if (jacobians != nullptr && jacobians[0] != nullptr) {
        Eigen::Map<RowMajor>(jacobians[0], size, stack_.free_.size()) =
            stack_.jacobian_.middleRows(row_, size);
      }
      return true;
    }

   private:
    const StackedResiduals& stack_;
    Eigen::Index row_;
  };

  const BasicProblem<S>& problem_;
  const FreeSet& free_;
  Eigen::VectorXd values_;
  const double* x_;
  Losses losses_;
  Evaluator<S> evaluator_;
  Eigen::VectorXd residual_;
  RowMajor jacobian_;
  bool defined_ = true;
};

}  // namespace kinecal
