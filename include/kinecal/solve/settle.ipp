// Fixes what a fit leaves open.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/solve/determined_spectrum.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/solve/settle.hpp"

namespace kinecal {

namespace detail {

/// True if the position of a joint may change by full turns: it rotates, and joints that mimic it
/// have whole multipliers.
[[nodiscard]] inline bool may_turn(const Robot& robot, const std::string& name) {
  if (!robot.has_joint(name) || !turns(robot.joint(name).type)) return false;
  for (const Joint& joint : robot.joints()) {
    if (joint.mimic && joint.mimic->joint == name &&
        joint.mimic->multiplier != std::round(joint.mimic->multiplier)) {
      return false;
    }
  }
  return true;
}

/// The free parameters among all values.
[[nodiscard]] inline Eigen::VectorXd of_free(const FreeSet& free, const Eigen::VectorXd& values) {
  return values(free.parameters());
}

[[nodiscard]] inline bool is_within_bounds(const ParameterTable& table, const FreeSet& free,
                                           const Eigen::VectorXd& values) {
  for (const int p : free.parameters()) {
    if (values(p) < table[p].lower || values(p) > table[p].upper) return false;
  }
  return true;
}

/// Moves to the point nearest to the start in the undetermined subspace, then down to the minimum.
/// @returns  the distance in that subspace, in units of effect
inline double hold_once(AnyEvaluator& evaluator, const Eigen::VectorXd& start,
                        Eigen::VectorXd& values) {
  const FreeSet& free = evaluator.free();
  Coordinates by = determined_coordinates(evaluator.problem(), free, numbers(values));
  if (by.null.cols() == 0) return 0.0;
  const Eigen::MatrixXd null = by.scale.asDiagonal() * by.null;  // orthonormal
  const Eigen::VectorXd drift =
      null.transpose() * by.scale.cwiseProduct(of_free(free, values) - of_free(free, start));
  Eigen::VectorXd held = of_free(free, values) - by.null * drift;
  for (int c = 0; c < free.size(); ++c) {
    values(free.parameters()[static_cast<std::size_t>(c)]) = held(c);
  }
  by = determined_coordinates(evaluator.problem(), free, numbers(values));
  const LinearFit fit = linear_fit(evaluator, numbers(values), by);
  constexpr double kSettled = 1e-15;
  const Eigen::VectorXd first = step_to_minimum(fit, fit.loss);
  values = refit(evaluator, numbers(values), fit, fit.loss, first, 1.0, kSettled).values;
  return drift.norm();
}

}  // namespace detail

KINECAL_INLINE void wrap_angles(const AnyProblem& problem, const FreeSet& free,
                                Eigen::VectorXd& values) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const ParameterTable& table = problem.table();
  for (const int p : free.parameters()) {
    if (std::abs(values(p)) > 0.5 * kTurn && detail::may_turn(problem.robot(), table[p].name)) {
      values(p) = std::remainder(values(p), kTurn);
    }
  }
  for (const std::string& frame : problem.frames()) {
    Eigen::Vector3i axes;
    for (int k = 0; k < 3; ++k) {
      axes(k) = table.find(parameter_name(frame, kFrameAxes[static_cast<std::size_t>(k) + 3]));
    }
    const bool all_free = (axes.array() >= 0).all() && free.column(axes(0)) >= 0 &&
                          free.column(axes(1)) >= 0 && free.column(axes(2)) >= 0;
    if (!all_free) continue;
    const double angle = values(axes).norm();
    if (angle <= 0.5 * kTurn) continue;
    const double factor = std::remainder(angle, kTurn) / angle;
    for (const int axis : axes) values(axis) *= factor;
  }
}

KINECAL_INLINE double hold_undetermined(const AnyProblem& problem, const FreeSet& free,
                                        const Eigen::VectorXd& start, Eigen::VectorXd& values) {
  const auto evaluator = problem.evaluator(free, 1);
  const auto cost = [&](const Eigen::VectorXd& at) {
    return evaluator->normal_equations(detail::numbers(at), false).cost;
  };
  const double before = cost(values);
  Eigen::VectorXd held = values;
  constexpr int kRounds = 20;
  constexpr double kStill = 1e-12;
  try {
    for (int round = 0; round < kRounds; ++round) {
      if (detail::hold_once(*evaluator, start, held) < kStill) break;
    }
  } catch (const std::domain_error&) {  // a point behind a camera
    return before;
  }
  constexpr double kSame = 1e-9;  // of the cost
  const double after = cost(held);
  if (!(after <= before * (1.0 + kSame)) ||
      !detail::is_within_bounds(problem.table(), free, held)) {
    return before;
  }
  values = held;
  return after;
}

}  // namespace kinecal
