// Solves one step with any evaluator.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "kinecal/solve/minimize.ipp"
#include "kinecal/solve/solve.hpp"

namespace kinecal {

namespace detail {

[[nodiscard]] inline bool all_losses_convex(const AnyProblem& problem) {
  bool convex = true;
  for (int t = 0; t < problem.num_terms(); ++t) {
    convex = convex && problem.term(t).options.loss.is_convex();
  }
  for (const PriorTerm& prior : problem.priors()) {
    convex = convex && prior.options.loss.is_convex();
  }
  return convex;
}

/// The name of a term whose loss ignores half of its features or more; empty if absent.
/// Such a "minimum" is a plateau.
[[nodiscard]] inline std::string mostly_left_out(AnyEvaluator& evaluator, ParameterValues values) {
  const AnyProblem& problem = evaluator.problem();
  if (all_losses_convex(problem)) return {};
  struct Features {
    int all = 0, left_out = 0;
  };
  std::vector<Features> of_terms(static_cast<std::size_t>(problem.num_terms()));
  (void)evaluator.evaluate(values, false, [&](int t, int, const TermResiduals& rows) {
    const Term& term = problem.term(t);
    const TermOptions& options = term.options;
    Features& features = of_terms[static_cast<std::size_t>(t)];
    for (Eigen::Index row = 0; row < rows.residual.size(); row += term.feature_size) {
      const double weight = term.weight * rows.factor(row);
      const double squared = rows.residual.segment(row, term.feature_size).squaredNorm();
      ++features.all;
      if (options.loss(weight * weight * squared).derivative == 0.0) ++features.left_out;
    }
  });
  for (int t = 0; t < problem.num_terms(); ++t) {
    const auto [all, left_out] = of_terms[static_cast<std::size_t>(t)];
    if (left_out > 0 && 2 * left_out >= all) return problem.term(t).name;
  }
  return {};
}

/// Clamps values to this step's bounds; an earlier step may have left them outside.
inline void clamp_to_bounds(const ParameterTable& table, const FreeSet& free,
                            Eigen::VectorXd& values) {
  for (const int p : free.parameters()) {
    values(p) = std::clamp(values(p), table[p].lower, table[p].upper);
  }
}

/// How far chi-square could still fall, to second order: g^T H^-1 g over the variance of the
/// residuals.  This scaling makes 2 cost / (residuals - parameters) one, with or without a given
/// sigma.  Exact samples leave rounding errors.  Parameters held at a bound do not move.
[[nodiscard]] inline double possible_decrease(AnyEvaluator& evaluator,
                                              const EvaluatorOf& evaluator_of,
                                              const Eigen::VectorXd& values,
                                              const StepResult& result) {
  const AnyProblem& problem = evaluator.problem();
  const FreeSet inside(within_bounds(evaluator, values, Losses::as_given), problem.table().size());
  if (inside.size() == 0) return 0.0;
  const NormalEquations normal = evaluator_of(inside)->normal_equations(
      {values.data(), static_cast<std::size_t>(values.size())});
  // The first rows of the equivalent residual are A^-T g, with H = A^T A.
  const Eigen::VectorXd projected = EquivalentResidual(normal).residual.head(inside.size());
  const auto spare =
      static_cast<double>(std::max<std::int64_t>(1, result.num_residuals - result.num_parameters));
  constexpr double kRounding = 1e-12;  // of what one unit of a parameter adds to a residual
  const double rounding = kRounding * kRounding * normal.hessian.diagonal().maxCoeff() / spare;
  const double variance = std::max(2.0 * normal.cost / spare, rounding);
  return variance > 0.0 ? projected.squaredNorm() / variance : 0.0;
}

/// Decides whether a solve that did not fail has converged: the decrease that is still possible must be
/// negligible against the noise.  What Ceres says is no proof: it also stops at the smallest of rejected steps,
/// or where a valley bends so much that steps hardly lower the cost, and calls both convergence.
inline void judge_convergence(AnyEvaluator& evaluator, const EvaluatorOf& evaluator_of,
                              const Eigen::VectorXd& values, const Minimum& last,
                              StepResult& result) {
  constexpr double kNegligible =
      1e-3;  // of chi-square, whose noise is sqrt(2 (residuals - parameters))
  const double decrease =
      last.proven ? 0.0 : possible_decrease(evaluator, evaluator_of, values, result);
  result.converged = decrease < kNegligible;
  std::ostringstream what;
  what.precision(2);
  what << (result.converged ? "converged" : "did not converge: ");
  if (last.converged && result.converged) {
    if (!last.message.empty()) what << ": " << last.message;
  } else if (last.converged) {
    what << "no step lowered the cost any further, though chi-square could still fall by about "
         << decrease << "; start elsewhere, or check the derivatives of error blocks of your own";
  } else {
    what << (result.converged ? ": " : "") << result.iterations
         << (result.iterations == 1 ? " iteration is" : " iterations are") << " used up, ";
    what << (result.converged ? "but what is left is noise: chi-square could fall by "
                              : "and chi-square could still fall by about ")
         << decrease;
  }
  result.termination = what.str();
}

/// Why a step cannot start.
[[nodiscard]] inline std::string why_undefined(const UndefinedResidual& undefined) {
  const std::string where =
      "'" + undefined.term + "' is not defined at the start for the sample at " + undefined.source;
  if (undefined.has_value) return "failed: a derivative of the residual of " + where;
  return "failed: the residual of " + where +
         " (a point that its camera does not see, or points that span no plane)";
}

/// Sets costs and counts at the start; returns false, with the reason, if there is nothing to
/// solve.
inline bool start(AnyEvaluator& evaluator, ParameterValues values, StepResult& result) {
  result.initial_cost = evaluator.normal_equations(values, false).cost;
  result.final_cost = result.initial_cost;
  std::optional<UndefinedResidual> undefined;
  if (!std::isfinite(result.initial_cost)) {
    undefined = evaluator.evaluate(values, false, [](int, int, const TermResiduals&) {});
  }
  if (undefined) {
    result.termination = why_undefined(*undefined);
    return false;
  }
  if (!std::isfinite(result.initial_cost)) {
    result.termination = "failed: the cost at the start is not finite";
  } else if (result.num_residuals < result.num_parameters) {
    result.termination = "failed: " + std::to_string(result.num_residuals) +
                         (result.num_residuals == 1 ? " residual" : " residuals") +
                         " cannot determine " + std::to_string(result.num_parameters) +
                         (result.num_parameters == 1 ? " parameter" : " parameters");
  }
  return result.termination.empty();
}

/// Solves a step from a start within its bounds.
/// @param result  with the numbers of samples, residuals and parameters
[[nodiscard]] inline StepResult solve_with(const EvaluatorOf& evaluator_of, const FreeSet& free,
                                           Eigen::VectorXd& values, const SolveOptions& options,
                                           StepResult result) {
  const std::unique_ptr<AnyEvaluator> evaluator = evaluator_of(free);
  const AnyProblem& problem = evaluator->problem();
  Eigen::VectorXd x = values;
  clamp_to_bounds(problem.table(), free, x);
  const std::span<const double> all(x.data(), static_cast<std::size_t>(x.size()));
  if (!start(*evaluator, all, result)) return result;
  const Eigen::VectorXd from = x;
  Minimum first;
  if (!all_losses_convex(problem)) {
    first = minimize(*evaluator, evaluator_of, x, options, Losses::convex);
  }
  const Minimum last = minimize(*evaluator, evaluator_of, x, options, Losses::as_given);
  result.iterations = first.iterations + last.iterations;
  result.costs = first.costs;
  result.costs.insert(result.costs.end(), last.costs.begin(), last.costs.end());
  result.seconds = first.seconds + last.seconds;
  result.evaluations = first.evaluations + last.evaluations;
  constexpr double kRounding = 1e-9;  // a start at the minimum may end slightly above it
  if (!last.usable) {
    const auto undefined =
        evaluator->evaluate({from.data(), all.size()}, true, [](int, int, const TermResiduals&) {});
    result.termination = undefined ? why_undefined(*undefined) : "failed: " + last.message;
  } else if (!std::isfinite(last.cost)) {
    result.termination = "failed: the cost is not finite";
  } else if (last.cost > result.initial_cost * (1.0 + kRounding)) {
    result.termination = "failed: the cost did not decrease";
  } else if (const std::string term = mostly_left_out(*evaluator, all); !term.empty()) {
    result.termination = "failed: the loss of '" + term +
                         "' leaves out half of its features or more; is its scale too small?";
  } else {
    judge_convergence(*evaluator, evaluator_of, x, last, result);
    result.final_cost = last.cost;
    values = x;
  }
  return result;
}

}  // namespace detail

}  // namespace kinecal
