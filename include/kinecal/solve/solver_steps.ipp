// Runs Ceres with careful steps first, then bold ones.
//
// Near the minimum, Gauss-Newton converges linearly: the decreases that its steps promise fall by the same factor
// or faster.  So what a step will leave is known before it is taken,
//
//   p_next = p^2 / p_last + what the linear model leaves
//
// where p is the promised decrease here and p_last that of the point before.  If p_next is negligible, the step is
// the last one: its end needs a cost, as a check, and no derivatives.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/solve.hpp"

namespace kinecal::detail {

/// The current cost after each iteration.  A rejected step leaves the values as they were, but its
/// summary has the cost of the trial: DBL_MAX where a residual is undefined.
class StandingCost {
 public:
  /// True if the iteration is the start or moved the values.
  bool add(const ceres::IterationSummary& summary) {
    const bool moved = summary.iteration == 0 || summary.step_is_successful;
    if (moved) cost_ = summary.cost;
    return moved;
  }
  [[nodiscard]] double cost() const { return cost_; }

 private:
  double cost_ = 0.0;
};

/// Reports progress, and stops when even an undamped step predicts no decrease, or where one step is left.
class StepCallback final : public ceres::IterationCallback {
 public:
  /// @param cost            of the problem, if it is the only one
  /// @param max_iterations  of this run, if the last step may be left to the caller; 0 if not
  StepCallback(const SolveOptions& options, const CompressedCost* cost, int max_iterations)
      : options_(options), cost_(cost), max_iterations_(max_iterations) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool moved = standing_.add(summary);
    if (options_.progress) options_.progress(summary.iteration, standing_.cost());
    if (!moved || cost_ == nullptr) return ceres::SOLVER_CONTINUE;
    const double negligible = options_.function_tolerance * standing_.cost();
    const double promised = cost_->promised_decrease();
    const double next = promised * (promised / promised_);
    promised_ = promised;
    if (promised <= negligible) return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
    constexpr double kSafety = 10.0;
    if (summary.iteration >= max_iterations_ || kSafety * next > negligible) {
      return ceres::SOLVER_CONTINUE;
    }
    GaussNewtonStep step = cost_->gauss_newton();
    if (kSafety * (next + step.left) > negligible) return ceres::SOLVER_CONTINUE;
    last_step_ = std::move(step.step);
    return ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

  /// (parameters) the step that is left; empty where the run has ended without one
  [[nodiscard]] const Eigen::VectorXd& last_step() const { return last_step_; }

 private:
  const SolveOptions& options_;
  const CompressedCost* cost_;
  int max_iterations_;
  StandingCost standing_;
  double promised_ = std::numeric_limits<double>::min();  ///< at the point before
  Eigen::VectorXd last_step_;
};

[[nodiscard]] inline ceres::Solver::Options ceres_options(const SolveOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  ceres_options.max_num_iterations = options.max_num_iterations;
  ceres_options.function_tolerance = options.function_tolerance;
  ceres_options.gradient_tolerance = 1e-16;
  ceres_options.parameter_tolerance = 1e-12;
  // Beyond, rounding lets the factorization fail, and Ceres logs that, silent or not.
  ceres_options.max_trust_region_radius = 1.0 / kNoCurvature;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.num_threads = 1;
  return ceres_options;
}

/// How long steps may be.
enum class Steps {
  careful,  ///< only downhill, from a small trust region
  bold      ///< long ones, some of them uphill
};

/// Calibrations have barely observable directions, at the bottom of curved valleys.  Careful steps
/// follow a valley in a tenth of the iterations of bold ones, which jump from side to side.  But
/// where many directions are barely observable they creep, and may stop short of the minimum.  So
/// careful steps come first and bold ones last: from where the careful ones ended, or from the
/// start if they failed.  Bold ones are skipped if even an undamped step predicts no decrease.
inline void set_steps(Steps steps, ceres::Solver::Options& options) {
  constexpr double kCareful = 1e4, kBold = 1e6;
  options.use_nonmonotonic_steps = steps == Steps::bold;
  options.initial_trust_region_radius = steps == Steps::bold ? kBold : kCareful;
}

/// The outcome of several runs of Ceres.
struct Minimum {
  bool usable = false, converged = false;
  bool proven = false;             ///< a Gauss-Newton step promises no decrease at the end
  std::string message;             ///< of the last run
  double cost = 0.0;               ///< at the end of the last run
  std::vector<double> costs = {};  ///< of each iteration of all runs
  int iterations = 0;              ///< of all runs
  int evaluations = 0;             ///< of all samples, of all runs
  double seconds = 0.0;
};

/// Adds a run to the outcome.
inline void add_run(const ceres::Solver::Summary& summary, Minimum& minimum) {
  minimum.usable = summary.IsSolutionUsable();
  const bool by_callback = summary.termination_type == ceres::USER_SUCCESS;
  minimum.converged = summary.termination_type == ceres::CONVERGENCE || by_callback;
  minimum.message = by_callback ? "" : summary.message;  // the callback has proved it
  minimum.cost = summary.final_cost;
  minimum.iterations += std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  minimum.proven = by_callback;
  StandingCost standing;
  for (const ceres::IterationSummary& iteration : summary.iterations) {
    standing.add(iteration);
    minimum.costs.push_back(standing.cost());
  }
  minimum.seconds += summary.total_time_in_seconds;
}

[[nodiscard]] inline bool is_within_bounds(const ceres::Problem& problem, const double* block,
                                           const Eigen::VectorXd& x) {
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const int c = static_cast<int>(i);
    if (x(i) < problem.GetParameterLowerBound(block, c)) return false;
    if (x(i) > problem.GetParameterUpperBound(block, c)) return false;
  }
  return true;
}

/// Takes the step that a run has left, if its end is within the bounds and the cost falls there as promised.
/// @param x        in: where the run ended; out: the end of the step, if it is taken
/// @param minimum  in and out: this step is added
/// @returns  whether it is taken
[[nodiscard]] inline bool take_last_step(const ceres::Problem& problem, std::vector<double>& x,
                                         const Eigen::VectorXd& step, const CompressedCost& cost,
                                         Minimum& minimum) {
  Eigen::Map<Eigen::VectorXd> here(x.data(), std::ssize(x));
  const Eigen::VectorXd there = here + step;
  if (!is_within_bounds(problem, x.data(), there)) return false;
  const double found = cost.cost_at(there);
  constexpr double kRounding = 1e-14;  // of the cost
  const double highest = minimum.cost * (1.0 + kRounding) - 0.5 * cost.promised_decrease();
  if (!(found <= highest)) return false;
  here = there;
  minimum.cost = found;
  minimum.costs.push_back(found);
  ++minimum.iterations;
  return true;
}

/// Runs Ceres from x to a minimum.
/// @param x        in: the start; out: where it ended
/// @param cost     of the problem, if it is the only one
/// @param minimum  in and out: this run is added
inline void take_steps(ceres::Problem& problem, std::vector<double>& x, const SolveOptions& options,
                       const CompressedCost* cost, Minimum& minimum) {
  ceres::Solver::Options solver = ceres_options(options);
  const std::vector<double> start = x;
  const std::size_t costs = minimum.costs.size();
  constexpr int kMostCareful = 20;  // iterations
  for (const Steps steps : {Steps::careful, Steps::bold}) {
    const bool is_bold = steps == Steps::bold;
    if (is_bold && !minimum.converged) {
      if (options.max_num_iterations <= kMostCareful) return;
      std::copy(start.begin(), start.end(), x.begin());
      minimum.costs.resize(costs);
    }
    set_steps(steps, solver);
    solver.max_num_iterations =
        is_bold ? options.max_num_iterations : std::min(kMostCareful, options.max_num_iterations);
    StepCallback callback(options, cost, is_bold ? 0 : solver.max_num_iterations);
    solver.callbacks = {&callback};
    ceres::Solver::Summary summary;
    const int evaluated = cost != nullptr ? cost->evaluations() : 0;
    ceres::Solve(solver, &problem, &summary);
    add_run(summary, minimum);
    const Eigen::VectorXd& last_step = callback.last_step();
    if (last_step.size() > 0) {
      minimum.proven = take_last_step(problem, x, last_step, *cost, minimum);
      if (minimum.proven && options.progress) {
        options.progress(static_cast<int>(summary.iterations.size()), minimum.cost);
      }
    }
    minimum.evaluations +=
        cost != nullptr ? cost->evaluations() - evaluated
                        : summary.num_residual_evaluations + summary.num_jacobian_evaluations;
    if (!minimum.usable || minimum.proven) return;
  }
}

}  // namespace kinecal::detail
