// A calibration: steps solved one after another, each starting where the last one ended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/statistics.hpp"

namespace kinecal {

/// One step, ready to be solved.
struct CalibrationStep {
  std::string name;
  int max_num_iterations = 1000;
  Problem problem;
  FreeSet free;
  std::vector<std::pair<int, double>> assignments;  ///< parameter, value: set before it starts
};

struct Calibration {
  ParameterTable table;  ///< all parameters of all steps, at their initial values
  std::vector<CalibrationStep> steps;
};

struct CalibrationResult {
  bool converged = false;   ///< all steps did
  std::string termination;  ///< of the last step that ran
  std::vector<StepResult> steps;
  std::vector<BlockStatistics> blocks;
  ParameterTable table;         ///< at the final values
  std::vector<int> calibrated;  ///< table indices of the parameters that some step freed
};

/// Called while a step runs: name of the step, iteration, cost.
using Progress = std::function<void(const std::string& step, int iteration, double cost)>;

namespace detail {

/// Blocks of one name in several steps are told once, as the last of them sees it.
inline void merge_statistics(std::vector<BlockStatistics>& all, std::vector<BlockStatistics> more) {
  for (BlockStatistics& block : more) {
    const auto same = std::find_if(all.begin(), all.end(),
                                   [&](const auto& known) { return known.name == block.name; });
    if (same == all.end()) {
      all.push_back(std::move(block));
    } else {
      *same = std::move(block);
    }
  }
}

}  // namespace detail

/// Solves all steps of a calibration, until one does not converge.
/// @param solving  how; the number of iterations is that of each step
[[nodiscard]] inline CalibrationResult calibrate(const Calibration& calibration,
                                                 const Progress& progress = {},
                                                 const SolveOptions& solving = {}) {
  CalibrationResult result;
  result.table = calibration.table;
  const Eigen::VectorXd initial = calibration.table.values();
  Eigen::VectorXd values = initial;
  for (const CalibrationStep& step : calibration.steps) {
    for (const auto& [parameter, value] : step.assignments) values(parameter) = value;
    SolveOptions options = solving;
    options.max_num_iterations = step.max_num_iterations;
    options.progress = {};
    if (progress) {
      options.progress = [&](int iteration, double cost) { progress(step.name, iteration, cost); };
    }
    StepResult solved = solve(step.problem, step.free, values, options);
    solved.name = step.name;
    for (int parameter : step.free.parameters()) {
      const auto& known = result.calibrated;
      if (std::find(known.begin(), known.end(), parameter) == known.end()) {
        result.calibrated.push_back(parameter);
      }
    }
    result.converged = solved.converged;
    result.termination = solved.termination;
    result.steps.push_back(std::move(solved));
    if (!result.converged) break;
  }
  const auto span = [](const Eigen::VectorXd& v) {
    return std::span<const double>(v.data(), static_cast<std::size_t>(v.size()));
  };
  for (std::size_t s = 0; s < result.steps.size(); ++s) {
    detail::merge_statistics(
        result.blocks, block_statistics(calibration.steps[s].problem, span(initial), span(values)));
  }
  for (int i = 0; i < result.table.size(); ++i) result.table[i].value = values(i);
  return result;
}

}  // namespace kinecal
