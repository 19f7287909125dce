// Runs Ceres with careful steps first, then bold ones.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <string>
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

/// Reports progress, and stops when even an undamped step predicts no decrease.
class StepCallback final : public ceres::IterationCallback {
 public:
  /// @param cost  of the problem, if it is the only one
  StepCallback(const SolveOptions& options, const CompressedCost* cost)
      : options_(options), cost_(cost) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool moved = standing_.add(summary);
    if (options_.progress) options_.progress(summary.iteration, standing_.cost());
    if (!moved || cost_ == nullptr) return ceres::SOLVER_CONTINUE;
    const bool promises =
        cost_->promised_decrease() > options_.function_tolerance * standing_.cost();
    return promises ? ceres::SOLVER_CONTINUE : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const SolveOptions& options_;
  const CompressedCost* cost_;
  StandingCost standing_;
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

/// Runs Ceres from x to a minimum.
/// @param x        in: the start; out: where it ended
/// @param cost     of the problem, if it is the only one
/// @param minimum  in and out: this run is added
inline void take_steps(ceres::Problem& problem, std::vector<double>& x, const SolveOptions& options,
                       const CompressedCost* cost, Minimum& minimum) {
  ceres::Solver::Options solver = ceres_options(options);
  StepCallback callback(options, cost);
  solver.callbacks.push_back(&callback);
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
    ceres::Solver::Summary summary;
    const int evaluated = cost != nullptr ? cost->evaluations() : 0;
    ceres::Solve(solver, &problem, &summary);
    add_run(summary, minimum);
    minimum.evaluations +=
        cost != nullptr ? cost->evaluations() - evaluated
                        : summary.num_residual_evaluations + summary.num_jacobian_evaluations;
    if (!minimum.usable || summary.termination_type == ceres::USER_SUCCESS) return;
  }
}

}  // namespace kinecal::detail
