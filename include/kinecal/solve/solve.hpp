// Solving one step with Ceres, and saying how it went.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "kinecal/solve/minimize.hpp"
#include "kinecal/solve/statistics.hpp"

namespace kinecal {

/// How a step ended.
struct StepResult {
  std::string name;
  bool converged = false;
  std::string termination;  ///< why it stopped, in a sentence
  int iterations = 0;
  double initial_cost = 0.0, final_cost = 0.0;  ///< 1/2 sum rho(|w r|^2)
  double seconds = 0.0;
  int num_residuals = 0, num_parameters = 0;
  CostForm form = CostForm::compressed;  ///< which path ran
  int samples = 0, evaluations = 0;      ///< evaluations of all samples, by Ceres
};

namespace detail {

template <class S>
[[nodiscard]] bool all_losses_convex(const BasicProblem<S>& problem) {
  bool convex = true;
  for (const auto& term : problem.terms()) convex = convex && term->options().loss.is_convex();
  for (const PriorTerm& prior : problem.priors()) {
    convex = convex && prior.options.loss.is_convex();
  }
  return convex;
}

/// The name of a term whose loss leaves out half of its features or more; empty if there is none.
/// Such a "minimum" is a plateau.
template <class S>
[[nodiscard]] std::string mostly_left_out(const BasicProblem<S>& problem,
                                          std::span<const double> values) {
  if (all_losses_convex(problem)) return {};
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

/// A value carried into a step from before lies outside of the step's bounds: the nearest one
/// inside.
inline void clamp_to_bounds(const ParameterTable& table, const FreeSet& free,
                            Eigen::VectorXd& values) {
  for (const int p : free.parameters()) {
    values(p) = std::clamp(values(p), table[p].lower, table[p].upper);
  }
}

/// Costs and counts at the start; false, with the reason, if there is nothing to solve.
template <class S>
bool start(Evaluator<S>& evaluator, std::span<const double> values, StepResult& result) {
  result.initial_cost = evaluator.normal_equations(values, false).cost;
  result.final_cost = result.initial_cost;
  std::optional<UndefinedResidual> undefined;
  if (!std::isfinite(result.initial_cost)) {
    undefined = undefined_residual(evaluator.problem(), values);
  }
  if (undefined) {
    result.termination = "failed: the residual of '" + undefined->term +
                         "' is not defined at the start for the sample at " + undefined->source +
                         " (a point behind a camera, or points that span no plane)";
    return false;
  }
  if (!std::isfinite(result.initial_cost)) {
    result.termination = "failed: the cost at the start is not finite";
  } else if (result.num_residuals < result.num_parameters) {
    result.termination = "failed: " + std::to_string(result.num_residuals) +
                         " residuals cannot tell " + std::to_string(result.num_parameters) +
                         " parameters";
  }
  return result.termination.empty();
}

}  // namespace detail

/// Minimizes the cost of a problem over its free parameters.
///
/// Where a loss is not convex (cauchy, tukey), a convex one is solved first: from far away they see
/// nothing.
/// @param free    which parameters may change
/// @param values  of all parameters of the problem's table: where to start, then where it ended.
///                Unchanged if the result is not usable (termination says why).
template <class S>
[[nodiscard]] StepResult solve(const BasicProblem<S>& problem, const FreeSet& free,
                               Eigen::VectorXd& values, const SolveOptions& options = {}) {
  StepResult result;
  result.num_parameters = free.size();
  // Priors count once for each sample.
  result.num_residuals = problem.num_residuals() + static_cast<int>(problem.priors().size()) *
                                                       Prior::kRows * (problem.num_samples() - 1);
  result.form = options.form;
  result.samples = problem.num_samples();
  Eigen::VectorXd x = values;
  detail::clamp_to_bounds(problem.table(), free, x);
  const std::span<const double> all(x.data(), static_cast<std::size_t>(x.size()));
  Evaluator<S> evaluator(problem, free, options.threads);
  if (!detail::start(evaluator, all, result)) return result;
  detail::Minimum first;
  if (!detail::all_losses_convex(problem)) {
    first = detail::minimize(evaluator, x, options, Losses::convex);
  }
  const detail::Minimum last = detail::minimize(evaluator, x, options, Losses::as_given);
  result.iterations = first.iterations + last.iterations;
  result.seconds = first.seconds + last.seconds;
  result.evaluations = first.evaluations + last.evaluations;
  constexpr double kRounding = 1e-9;  // a start at the minimum may end a few digits above it
  if (!last.usable) {
    result.termination = "failed: " + last.message;
  } else if (!std::isfinite(last.cost)) {
    result.termination = "failed: the cost is not finite";
  } else if (last.cost > result.initial_cost * (1.0 + kRounding)) {
    result.termination = "failed: the cost did not decrease";
  } else if (const std::string term = detail::mostly_left_out(problem, all); !term.empty()) {
    result.termination = "failed: the loss of '" + term +
                         "' leaves out half of its features or more; is its scale too small?";
  } else {
    result.converged = last.converged;
    result.termination = (last.converged ? "converged: " : "did not converge: ") + last.message;
    result.final_cost = last.cost;
    values = x;
  }
  return result;
}

}  // namespace kinecal
