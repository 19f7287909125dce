// A method: one way to evaluate the residuals of all samples, for timing and checking.
//
// A timed evaluation stores its results as it suits the method; `stacked` returns them in one
// layout for the checks.  Normal equations are the sums that a solver needs:
//
//   cost = 1/2 r^T r      gradient = J^T r      hessian = J^T J
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <chrono>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "work.hpp"

namespace kinecal::bench {

using Values = std::span<const double, kParameters>;
using RowMajorBlock = Eigen::Matrix<double, kRows, kParameters, Eigen::RowMajor>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, kParameters, Eigen::RowMajor>;

struct Stacked {
  Eigen::VectorXd residual;  ///< (12 a sample) metres
  RowMajor jacobian;         ///< (12 a sample x 26)
};

struct Sums {
  double cost = 0.0;
  Eigen::Matrix<double, kParameters, 1> gradient = Eigen::Matrix<double, kParameters, 1>::Zero();
  Eigen::Matrix<double, kParameters, kParameters> hessian =
      Eigen::Matrix<double, kParameters, kParameters>::Zero();
};

struct Solved {
  double seconds = 0.0;  ///< from resolved samples to the result
  double cost = 0.0;
  int iterations = 0;
  bool converged = false;
  Eigen::VectorXd values;
};

/// Floating-point operations per sample; 0 if unknown.
struct Flops {
  double residual = 0.0, residual_jacobian = 0.0, normal_equations = 0.0;
};

struct Method {
  std::string name;
  bool exact = true;  ///< derivatives are exact, not differences
  std::function<void(Values)> residuals;
  std::function<void(Values)> residuals_jacobian;
  std::function<Sums(Values)> normal_equations;           ///< with residuals and Jacobian
  std::function<Stacked(Values, bool jacobian)> stacked;  ///< without Jacobian: residuals alone
  std::function<Solved(int samples)> solve;               ///< from the initial values
  Flops flops = {};
};

/// J^T J and J^T r of stacked rows, in one product over the rows of all samples.
[[nodiscard]] inline Sums sums_of(const Stacked& stacked) {
  Sums sums;
  sums.cost = 0.5 * stacked.residual.squaredNorm();
  sums.gradient.noalias() = stacked.jacobian.transpose() * stacked.residual;
  sums.hessian.noalias() = stacked.jacobian.transpose() * stacked.jacobian;
  return sums;
}

/// A solve that is predicted to take longer is skipped; one that takes twice as long is stopped.
inline constexpr double kLongestSolve = 20.0;  // seconds

/// Options for all methods that solve with Ceres: steps as in the library, and normal equations,
/// which are fastest for many rows of few columns.  The cost is minimized to ten digits.  Beyond
/// that, numeric differences and rounding decide, and a method drifts along unobservable parameter
/// combinations until its time is over.
[[nodiscard]] inline ceres::Solver::Options solver_options() {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.max_num_iterations = 1000;
  options.max_solver_time_in_seconds = 2.0 * kLongestSolve;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-16;
  options.parameter_tolerance = 1e-12;
  options.use_nonmonotonic_steps = true;
  options.initial_trust_region_radius = 1e6;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

/// Solves with one residual block per sample.
/// @param costs     cost functions of 12 x 26, one per sample; the caller keeps ownership
/// @param x         (26) in: start; out: solution
/// @param callback  called before each evaluation, or nullptr
/// @throws std::runtime_error  if Ceres does not find a solution
template <class CostFunction>
[[nodiscard]] Solved solve_with_ceres(const std::vector<std::unique_ptr<CostFunction>>& costs,
                                      Eigen::VectorXd& x,
                                      ceres::EvaluationCallback* callback = nullptr) {
  const auto start = std::chrono::steady_clock::now();
  ceres::Problem::Options problem_options;
  problem_options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  problem_options.evaluation_callback = callback;
  ceres::Problem problem(problem_options);
  for (const auto& cost : costs) problem.AddResidualBlock(cost.get(), nullptr, x.data());
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(), &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    throw std::runtime_error("Ceres found no solution: " + summary.message);
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  return {seconds.count(), summary.final_cost, static_cast<int>(summary.iterations.size()) - 1,
          summary.termination_type == ceres::CONVERGENCE, x};
}

}  // namespace kinecal::bench
