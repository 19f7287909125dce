// Solves one step with any evaluator.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/stacked_cost.hpp"

namespace kinecal::detail {

// Runs Ceres with careful steps first, then bold ones.
//
// Near the minimum, Gauss-Newton converges linearly: the decreases that its steps promise fall by the same factor
// or faster.  So what a step will leave is known before it is taken,
//
//   p_next = p^2 / p_last + what the linear model leaves
//
// where p is the promised decrease here and p_last that of the point before.  If p_next is negligible, the step is
// the last one: its end needs a cost, as a check, and no derivatives.

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

// Minimizing the cost of a problem with Ceres, bounds included.
//
// Ceres enforces bounds by projecting its steps, and converges slowly where a bound is active.  So
// we use an active set: parameters that end at a bound, with the cost still falling beyond it, are
// held there, and the others are minimized again, until the set is stable.
// Source: Nocedal, Wright, Numerical Optimization, 16.5.

inline void set_bounds(ceres::Problem& problem, const ParameterTable& table, const FreeSet& free,
                       double* x) {
  for (int c = 0; c < free.size(); ++c) {
    const Parameter& parameter = table[free.parameters()[static_cast<std::size_t>(c)]];
    if (std::isfinite(parameter.lower)) problem.SetParameterLowerBound(x, c, parameter.lower);
    if (std::isfinite(parameter.upper)) problem.SetParameterUpperBound(x, c, parameter.upper);
  }
}

/// Minimizes over the evaluator's free parameters.
/// @param values  in: where to start; out: where it ended, if usable
inline void run_ceres(AnyEvaluator& evaluator, Eigen::VectorXd& values, const SolveOptions& options,
                      Losses losses, Minimum& minimum) {
  const AnyProblem& problem = evaluator.problem();
  const FreeSet& free = evaluator.free();
  std::vector<double> x;
  for (int p : free.parameters()) x.push_back(values(p));
  ceres::Problem::Options problem_options;
  std::optional<StackedResiduals> stack;
  if (options.form == CostForm::stacked) {
    problem_options.evaluation_callback = &stack.emplace(problem, free, values, x.data(), losses);
  }
  ceres::Problem ceres_problem(problem_options);
  const CompressedCost* compressed = nullptr;
  if (stack) {
    stack->add_to(ceres_problem, x.data());
  } else {
    auto* cost = new CompressedCost(evaluator, values, losses);
    ceres_problem.AddResidualBlock(cost, nullptr, x.data());
    compressed = cost;
  }
  if (stack ? !stack->is_defined() : !compressed->is_defined_at(x.data())) {
    minimum.usable = minimum.converged = false;
    minimum.message = "a residual or a derivative is not defined at the start";
    return;
  }
  if (compressed != nullptr) minimum.evaluations += compressed->evaluations();
  set_bounds(ceres_problem, problem.table(), free, x.data());
  take_steps(ceres_problem, x, options, compressed, minimum);
  if (!minimum.usable) return;
  for (int c = 0; c < free.size(); ++c) {
    values(free.parameters()[static_cast<std::size_t>(c)]) = x[static_cast<std::size_t>(c)];
  }
}

[[nodiscard]] inline bool has_bounds(const ParameterTable& table, const FreeSet& free) {
  const auto is_bounded = [&](int p) {
    return std::isfinite(table[p].lower) || std::isfinite(table[p].upper);
  };
  return std::any_of(free.parameters().begin(), free.parameters().end(), is_bounded);
}

/// The free parameters, without those at a bound beyond which the cost would fall.
[[nodiscard]] inline std::vector<int> within_bounds(AnyEvaluator& evaluator,
                                                    const Eigen::VectorXd& values, Losses losses) {
  const FreeSet& free = evaluator.free();
  const NormalEquations normal = evaluator.normal_equations(
      {values.data(), static_cast<std::size_t>(values.size())}, true, losses);
  std::vector<int> inside;
  for (int c = 0; c < free.size(); ++c) {
    const int index = free.parameters()[static_cast<std::size_t>(c)];
    const Parameter& parameter = evaluator.problem().table()[index];
    constexpr double kAtBound = 1e-12;  // of the value
    const double near = kAtBound * (1e-3 + std::abs(values(index)));
    const double slope = normal.gradient(c);
    const bool held = (values(index) <= parameter.lower + near && slope > 0.0) ||
                      (values(index) >= parameter.upper - near && slope < 0.0);
    if (!held) inside.push_back(index);
  }
  return inside;
}

/// Makes evaluators of the same samples for other free parameters.
using EvaluatorOf = std::function<std::unique_ptr<AnyEvaluator>(const FreeSet&)>;

/// Minimizes over the evaluator's free parameters, within their bounds.
/// @param values  in: where to start; out: where it ended, if usable
[[nodiscard]] inline Minimum minimize(AnyEvaluator& evaluator, const EvaluatorOf& evaluator_of,
                                      Eigen::VectorXd& values, const SolveOptions& options,
                                      Losses losses) {
  const AnyProblem& problem = evaluator.problem();
  const FreeSet& free = evaluator.free();
  Minimum minimum;
  const Eigen::VectorXd start = values;
  run_ceres(evaluator, values, options, losses, minimum);
  if (!has_bounds(problem.table(), free)) return minimum;
  std::vector<int> inside = free.parameters();
  const int rounds = 2 * free.size() + 2;  // each round usually settles several bounds
  for (int round = 0; minimum.usable && round < rounds; ++round) {
    std::vector<int> next = within_bounds(evaluator, values, losses);
    if (next == inside || next.empty()) return minimum;
    inside = std::move(next);
    // Restart: crawling along a bound also drifts along unobservable directions.
    for (const int p : inside) values(p) = start(p);
    const auto of_inside = evaluator_of(FreeSet(inside, problem.table().size()));
    run_ceres(*of_inside, values, options, losses, minimum);
  }
  return minimum;
}

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

}  // namespace kinecal::detail
