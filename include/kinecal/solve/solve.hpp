// Solving one step with Ceres, and saying how it went.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <cmath>
#include <functional>
#include <string>

#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/statistics.hpp"

namespace kinecal {

struct SolveOptions {
  int max_num_iterations = 1000;
  /// Called after each iteration with its number and cost.
  std::function<void(int iteration, double cost)> progress = {};
};

/// How a step ended.
struct StepResult {
  std::string name;
  bool converged = false;
  std::string termination;  ///< why it stopped, in a sentence
  int iterations = 0;
  double initial_cost = 0.0, final_cost = 0.0;  ///< 1/2 sum rho(|w r|^2)
  double seconds = 0.0;
  int num_residuals = 0, num_parameters = 0;
};

namespace detail {

class ProgressCallback final : public ceres::IterationCallback {
 public:
  explicit ProgressCallback(const SolveOptions& options) : options_(options) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (options_.progress) options_.progress(summary.iteration, summary.cost);
    return ceres::SOLVER_CONTINUE;
  }

 private:
  const SolveOptions& options_;
};

[[nodiscard]] inline std::string explain(const ceres::Solver::Summary& summary) {
  switch (summary.termination_type) {
    case ceres::CONVERGENCE: return "converged: " + summary.message;
    case ceres::NO_CONVERGENCE: return "did not converge: " + summary.message;
    default: return "failed: " + summary.message;
  }
}

[[nodiscard]] inline ceres::Solver::Options ceres_options(const SolveOptions& options) {
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::DENSE_QR;
  ceres_options.max_num_iterations = options.max_num_iterations;
  // The cost is compared with reference figures to many digits, and an iteration costs little.
  ceres_options.function_tolerance = 1e-14;
  ceres_options.gradient_tolerance = 1e-16;
  ceres_options.parameter_tolerance = 1e-12;
  // Calibrations have directions that the data hardly see, at the bottom of curved valleys: steps
  // along them are long, and now and then lead uphill first.  On a robot with 51 parameters of which
  // 25 can be seen this takes 30 to 130 iterations; monotonic steps from the default radius stop
  // short of the minimum.
  ceres_options.use_nonmonotonic_steps = true;
  ceres_options.initial_trust_region_radius = 1e6;
  ceres_options.logging_type = ceres::SILENT;
  ceres_options.num_threads = 1;
  return ceres_options;
}

/// Number of residuals of a problem, priors counted once for each sample.
[[nodiscard]] inline int count_residuals(const Problem& problem, std::span<const double> values) {
  Eigen::Index rows = 0;
  (void)problem.evaluate(values, nullptr, [&](int, int, const TermResiduals& residuals) {
    rows += residuals.residual.size();
  });
  rows += static_cast<Eigen::Index>(problem.priors().size()) * Prior::kRows * problem.num_samples();
  return static_cast<int>(rows);
}

/// Runs Ceres on the free parameters, from the given values of all parameters.
/// @param values  in: where to start; out: where it ended, if that is usable
inline ceres::Solver::Summary minimize(const Problem& problem, const FreeSet& free,
                                       Eigen::VectorXd& values, const SolveOptions& options,
                                       Losses losses) {
  CompressedCost cost(problem, free, values, losses);
  std::vector<double> x;
  for (int p : free.parameters()) x.push_back(values(p));
  ceres::Problem::Options ownership;
  ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem ceres_problem(ownership);
  ceres_problem.AddResidualBlock(&cost, nullptr, x.data());
  for (int c = 0; c < free.size(); ++c) {
    const Parameter& parameter = problem.table()[free.parameters()[static_cast<std::size_t>(c)]];
    if (std::isfinite(parameter.lower)) {
      ceres_problem.SetParameterLowerBound(x.data(), c, parameter.lower);
    }
    if (std::isfinite(parameter.upper)) {
      ceres_problem.SetParameterUpperBound(x.data(), c, parameter.upper);
    }
  }
  ceres::Solver::Options solver = ceres_options(options);
  ProgressCallback progress(options);
  solver.callbacks.push_back(&progress);
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &ceres_problem, &summary);
  if (!summary.IsSolutionUsable()) return summary;
  for (int c = 0; c < free.size(); ++c) {
    values(free.parameters()[static_cast<std::size_t>(c)]) = x[static_cast<std::size_t>(c)];
  }
  return summary;
}

[[nodiscard]] inline bool all_losses_convex(const Problem& problem) {
  bool convex = true;
  for (const auto& term : problem.terms()) convex = convex && term->options().loss.is_convex();
  for (const PriorTerm& prior : problem.priors()) {
    convex = convex && prior.options.loss.is_convex();
  }
  return convex;
}

/// The name of a term whose loss leaves out half of its features or more; empty if there is none.
/// Such a "minimum" is a plateau.
[[nodiscard]] inline std::string mostly_left_out(const Problem& problem,
                                                 std::span<const double> values) {
  const auto norms = feature_norms(problem, values);
  for (std::size_t t = 0; t < norms.size(); ++t) {
    const TermOptions& options = problem.terms()[t]->options();
    const auto left_out = std::count_if(norms[t].begin(), norms[t].end(), [&](double norm) {
      const double weighted = options.weight * norm;
      return options.loss(weighted * weighted).derivative == 0.0;
    });
    if (left_out > 0 && 2 * left_out >= static_cast<std::ptrdiff_t>(norms[t].size())) {
      return problem.terms()[t]->name();
    }
  }
  return {};
}

/// Costs and counts at the start; false, with the reason, if there is nothing to solve.
inline bool start(const Problem& problem, std::span<const double> values, StepResult& result) {
  std::optional<UndefinedResidual> undefined;
  result.initial_cost = normal_equations(problem, values, nullptr, undefined).cost;
  result.final_cost = result.initial_cost;
  if (undefined) {
    result.termination = "failed: the residual of '" + undefined->term +
                         "' is not defined at the start for the sample at " + undefined->source +
                         " (a point behind a camera, or points that span no plane)";
    return false;
  }
  result.num_residuals = count_residuals(problem, values);
  if (result.num_residuals == 0) result.termination = "failed: no residuals";
  return result.num_residuals > 0;
}

}  // namespace detail

/// Minimizes the cost of a problem over its free parameters.
///
/// Where a loss is not convex (cauchy, tukey), a convex one is solved first: from far away they see
/// nothing.
/// @param free    which parameters may change
/// @param values  of all parameters of the problem's table: where to start, then where it ended.
///                Unchanged if the result is not usable (termination says why).
[[nodiscard]] inline StepResult solve(const Problem& problem, const FreeSet& free,
                                      Eigen::VectorXd& values, const SolveOptions& options = {}) {
  StepResult result;
  result.num_parameters = free.size();
  Eigen::VectorXd x = values;
  const std::span<const double> all(x.data(), static_cast<std::size_t>(x.size()));
  if (!detail::start(problem, all, result)) return result;
  if (!detail::all_losses_convex(problem)) {
    const auto first = detail::minimize(problem, free, x, options, Losses::convex);
    result.iterations += static_cast<int>(first.iterations.size()) - 1;
    result.seconds += first.total_time_in_seconds;
  }
  const auto summary = detail::minimize(problem, free, x, options, Losses::as_given);
  result.iterations += static_cast<int>(summary.iterations.size()) - 1;
  result.seconds += summary.total_time_in_seconds;
  result.termination = detail::explain(summary);
  if (!summary.IsSolutionUsable()) return result;
  if (!std::isfinite(summary.final_cost)) {
    result.termination = "failed: the cost is not finite";
  } else if (summary.final_cost > result.initial_cost) {
    result.termination = "failed: the cost did not decrease";
  } else if (const std::string term = detail::mostly_left_out(problem, all); !term.empty()) {
    result.termination = "failed: the loss of '" + term +
                         "' leaves out half of its features or more; is its scale too small?";
  } else {
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.final_cost = summary.final_cost;
    values = x;
  }
  return result;
}

}  // namespace kinecal
