// The difference between a calibration's result and that of the linearized problem, for
// repeatability.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/study/repeatability.hpp"
#include "kinecal/trust/plain_equations.hpp"

namespace kinecal::detail {

/// Picks the equivalent values nearest to the truth: angles of joints, and rotation vectors of
/// frames, modulo full turns.
inline void turn_nearest(const AnyProblem& problem, const std::vector<double>& truth,
                         std::vector<double>& values) {
  const ParameterTable& table = problem.table();
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (int p = 0; p < table.size(); ++p) {
    const Robot& robot = problem.robot();
    const std::string& name = table[p].name;
    if (!robot.has_joint(name) || !turns(robot.joint(name).type)) continue;
    const auto i = static_cast<std::size_t>(p);
    values[i] -= kTurn * std::round((values[i] - truth[i]) / kTurn);
  }
  for (const std::string& frame : problem.frames()) {
    Vector3<double> turn, of_truth;
    std::array<std::size_t, 3> places{};
    bool has_all = true;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      const int p = table.find(parameter_name(frame, kFrameAxes[k + 3]));
      has_all = has_all && p >= 0;
      if (p < 0) break;
      places[k] = static_cast<std::size_t>(p);
      turn(axis) = values[places[k]];
      of_truth(axis) = truth[places[k]];
    }
    const double angle = has_all ? turn.norm() : 0.0;
    if (!(angle > 0.0)) continue;
    const Vector3<double> other = turn * (1.0 - kTurn / angle);
    if ((other - of_truth).norm() >= (turn - of_truth).norm()) continue;
    for (std::size_t k = 0; k < 3; ++k) values[places[k]] = other(static_cast<Eigen::Index>(k));
  }
}

/// Weighted rows of a problem in evaluation order; the priors' part of the normal equations is
/// computed separately.
struct StackedRows {
  std::vector<double> residual;
  std::vector<double> moved;  ///< J step
};

[[nodiscard]] inline StackedRows stacked_rows(AnyEvaluator& evaluator, ParameterValues values,
                                              const Eigen::VectorXd& step) {
  StackedRows all;
  (void)evaluator.evaluate(values, step.size() > 0, [&](int term, int, const TermResiduals& rows) {
    const double weight = evaluator.problem().term(term).weight;
    for (Eigen::Index row = 0; row < rows.residual.size(); ++row) {
      const double factor = weight * rows.factor(row);
      all.residual.push_back(factor * rows.residual(row));
      if (step.size() > 0) all.moved.push_back(factor * rows.jacobian.row(row).dot(step));
    }
  });
  return all;
}

/// See StudyTrial::nonlinearity.
[[nodiscard]] inline double nonlinearity(const StudySetup& setup, const StudyRobot& robot,
                                         std::span<const Sample> measured,
                                         const std::vector<double>& found) {
  const std::unique_ptr<AnyProblem> problem = setup.make();
  for (const Sample& sample : measured) problem->add_sample(sample);
  const FreeSet free(setup.free, problem->table().size());
  const std::unique_ptr<AnyEvaluator> evaluator = problem->evaluator(free, 1);
  const PlainEquations at_truth = plain_equations(*problem, free, robot.truth);
  const Eigen::MatrixXd hessian = at_truth.hessian.matrix();
  const Eigen::VectorXd units =
      hessian.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 1.0; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(units.asDiagonal() * hessian *
                                                              units.asDiagonal());
  constexpr double kNothing = 1e-11;  // of the largest eigenvalue
  const double least = kNothing * solver.eigenvalues()(free.size() - 1);
  const Eigen::VectorXd slope =
      solver.eigenvectors().transpose() * units.cwiseProduct(at_truth.gradient.matrix().col(0));
  const Eigen::VectorXd along = slope.binaryExpr(
      solver.eigenvalues(), [&](double g, double e) { return e > least ? -g / e : 0.0; });
  const Eigen::VectorXd step = units.cwiseProduct(solver.eigenvectors() * along);
  const StackedRows before = stacked_rows(*evaluator, robot.truth, step),
                    after = stacked_rows(*evaluator, found, {});
  if (before.residual.size() != after.residual.size()) return 1.0;  // some are undefined
  double far = 0.0, off = 0.0;
  for (std::size_t i = 0; i < before.residual.size(); ++i) {
    const double linear = before.residual[i] + before.moved[i];
    far += before.moved[i] * before.moved[i];
    off += (after.residual[i] - linear) * (after.residual[i] - linear);
  }
  return far > 0.0 ? std::sqrt(off / far) : 0.0;
}

}  // namespace kinecal::detail
