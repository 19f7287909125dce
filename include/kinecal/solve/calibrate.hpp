// A calibration: steps solved one after another, each starting where the last one ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/starts.hpp"
#include "kinecal/solve/statistics.hpp"

namespace kinecal {

/// One step, ready to be solved.
struct CalibrationStep {
  std::string name;                     ///< for reports and messages
  int max_num_iterations = 1000;        ///< the step does not converge if it needs more
  std::unique_ptr<AnyProblem> problem;  ///< with its samples
  FreeSet free;                         ///< the parameters that the step calibrates
  /// Table index and value of the parameters to set before the step starts.
  std::vector<std::pair<int, double>> assignments;
  std::vector<UnknownFrame> unknown_frames = {};  ///< frames whose pose to search for
  std::unique_ptr<AnyProblem> excerpt = nullptr;  ///< a few samples for that search; null: all
  std::vector<int> of_excerpt = {};  ///< of each sample of the excerpt: its number in the problem

  /// Sets the noise of an error block: AnyProblem::set_sigma(), in the excerpt, too.
  void set_sigma(int term, double sigma);
  /// Leaves samples out: AnyProblem::exclude(), in the excerpt, too.  Parameters that affect none of
  /// the residuals that are left are not free any more.
  /// @throws std::invalid_argument  if no free parameter affects a residual any more
  void exclude(const std::set<int>& samples);
};

/// Everything that calibrate() needs.
struct Calibration {
  ParameterTable table;  ///< all parameters of all steps: Parameter::value is the initial one
  std::vector<CalibrationStep> steps;  ///< in the order in which they are solved
  /// Where the first step begins, if an earlier solution is nearer than the initial values; of each parameter.
  std::vector<double> begin = {};
};

/// Leaves samples out of all steps.
/// @param samples  their numbers in the problems
/// @param list     the samples of the problems, of which they are erased
/// @throws std::invalid_argument  as CalibrationStep::exclude()
void exclude(Calibration& calibration, const std::set<int>& samples, std::vector<Sample>& list);

/// The result of a calibration.
struct CalibrationResult {
  bool converged = false;               ///< every step converged
  std::string termination;              ///< of the last step that ran
  std::vector<StepResult> steps;        ///< the steps that ran
  std::vector<BlockStatistics> blocks;  ///< of error blocks and priors, before and after
  ParameterTable table;         ///< at the final values, with those before as Parameter::initial
  std::vector<int> calibrated;  ///< table indices of all parameters that some step freed
};

/// Called while a step runs: name of the step, iteration, cost.
using Progress = std::function<void(const std::string& step, int iteration, double cost)>;

/// Solves the steps of a calibration in order; stops at the first that does not converge.
/// @param solving  options of all steps; each step has its own number of iterations
[[nodiscard]] CalibrationResult calibrate(const Calibration& calibration,
                                          const Progress& progress = {},
                                          const SolveOptions& solving = {});

namespace detail {
/// Adds a step that has run: its parameters, whether it converged.
void add_step(StepResult step, const FreeSet& free, CalibrationResult& result);
/// Adds statistics of error blocks; those of a block that occurs in several steps are the last step's.
void merge_statistics(std::vector<BlockStatistics>& all, std::vector<BlockStatistics> more);
}  // namespace detail

/// A calibration of one step: the problem with these samples.  Free parameters that affect none of
/// the residuals keep their initial values.  Where the start fails, poses of virtual frames and of fixed joints
/// that are free in all axes are searched for.
/// @param problem  without samples
/// @throws SampleError  naming the sample and what is missing or wrong in it
/// @throws std::invalid_argument  if a free parameter belongs to no joint, frame or sensor, or if
///                                no error block can use any of the samples
[[nodiscard]] Calibration make_calibration(std::unique_ptr<AnyProblem> problem, const FreeSet& free,
                                           std::span<const Sample> samples,
                                           const std::string& step = "calibration");

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/calibrate.ipp"
#endif
