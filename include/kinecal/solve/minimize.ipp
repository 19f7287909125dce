// Minimizing the cost of a problem with Ceres, bounds included.
//
// Ceres enforces bounds by projecting its steps, and converges slowly where a bound is active.  So
// we use an active set: parameters that end at a bound, with the cost still falling beyond it, are
// held there, and the others are minimized again, until the set is stable.
// Source: Nocedal, Wright, Numerical Optimization, 16.5.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/solve/compressed_cost.hpp"
#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/solver_steps.ipp"
#include "kinecal/solve/stacked_cost.hpp"

namespace kinecal {

namespace detail {

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

}  // namespace detail
}  // namespace kinecal
