// Solves one step of a calibration with Ceres.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/solve/pose_search.hpp"
#include "kinecal/solve/start_summary.hpp"

namespace kinecal {

/// How Ceres receives the samples: summed (compressed_cost.hpp) or one by one (stacked_cost.hpp).
enum class CostForm { compressed, stacked };

/// "compressed" or "stacked".
[[nodiscard]] constexpr std::string_view to_string(CostForm form) {
  return form == CostForm::compressed ? "compressed" : "stacked";
}

/// How to solve a step.
struct SolveOptions {
  int max_num_iterations = 1000;  ///< the step does not converge if it needs more
  /// Stops when an iteration lowers the cost by less than this fraction, or a Gauss-Newton step
  /// predicts less, here or after one more step.  The default is small: iterations are cheap, and costs are compared to many
  /// digits.
  double function_tolerance = 1e-14;
  CostForm form = CostForm::compressed;  ///< how Ceres receives the samples
  int threads = 0;                       ///< zero: one per core; does not affect the result
  int random_starts = 0;                 ///< of calibrate(), besides the one given
  PoseSearch search = {};                ///< of calibrate(), for unknown poses
  bool hold_undetermined = true;  ///< of calibrate(): see settle.hpp; does not affect the cost
  /// Called after each iteration with its number and the current cost; a rejected step leaves the
  /// cost as it was.
  std::function<void(int iteration, double cost)> progress = {};
  ProgressMeter meter = {};  ///< called after each of several starts
};

/// How a step ended.
struct StepResult {
  std::string name;                      ///< of the step; solve() leaves it empty
  bool converged = false;                ///< the values are a minimum
  std::string termination;               ///< why it stopped, as a sentence
  int iterations = 0;                    ///< of Ceres, all runs
  double initial_cost = 0.0;             ///< 1/2 sum rho(|w r|^2) at the start
  double final_cost = 0.0;               ///< the same at the end
  double seconds = 0.0;                  ///< wall time
  std::int64_t num_residuals = 0;        ///< components; a prior counts once per sample
  int num_parameters = 0;                ///< free parameters
  CostForm form = CostForm::compressed;  ///< the one that was used
  std::int64_t samples = 0;              ///< of the problem
  int evaluations = 0;                   ///< how often all samples were evaluated
  StartSummary starts = {};              ///< of solve_from_starts(), if there were several
  std::vector<double> costs = {};  ///< after each iteration, from the start; if losses are not
                                   ///< convex, the solve with convex losses comes first
};

/// Minimizes the cost of a problem over its free parameters.
///
/// If a loss is not convex (cauchy, tukey), the problem is first solved with a convex loss, because
/// the gradient of such a loss vanishes far from the minimum.
/// @param free    the parameters that may change
/// @param values  of all parameters of the problem's table: in: where to start; out: where it
///                ended.  Unchanged if the result is not usable (see StepResult::termination)
/// @throws std::invalid_argument  if a free parameter belongs to no joint, frame or sensor of the
///                                problem, if the number of values is not that of its table, or if
///                                nothing is free
[[nodiscard]] StepResult solve(const AnyProblem& problem, const FreeSet& free,
                               Eigen::VectorXd& values, const SolveOptions& options = {});

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/solve.ipp"
#endif
