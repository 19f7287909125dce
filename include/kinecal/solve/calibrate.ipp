// Solving the steps of a calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <stdexcept>

#include "kinecal/solve/calibrate.hpp"
#include "kinecal/solve/settle.hpp"

namespace kinecal {

namespace detail {

/// A block that occurs in several steps is reported once, with the statistics of the last step.
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

KINECAL_INLINE CalibrationResult calibrate(const Calibration& calibration, const Progress& progress,
                                           const SolveOptions& solving) {
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
    const Eigen::VectorXd start = values;
    StepResult solved = solve_from_starts(*step.problem, step.free, values, options,
                                          step.unknown_frames, step.excerpt.get());
    if (solved.converged) {
      wrap_angles(*step.problem, step.free, values);
      solved.final_cost = hold_undetermined(*step.problem, step.free, start, values);
    }
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
    detail::merge_statistics(result.blocks, block_statistics(*calibration.steps[s].problem,
                                                             span(initial), span(values)));
  }
  for (int i = 0; i < result.table.size(); ++i) result.table[i].value = values(i);
  return result;
}

KINECAL_INLINE Calibration make_calibration(std::unique_ptr<AnyProblem> problem,
                                            const FreeSet& free, std::span<const Sample> samples,
                                            const std::string& step) {
  problem->check(free);
  for (const Sample& sample : samples) problem->add_sample(sample);
  const std::vector<int> touched = problem->touched_parameters();
  if (touched.empty()) {
    throw std::invalid_argument("no sample has usable features of all sensors of an error block");
  }
  std::vector<int> determined = free.parameters();
  std::erase_if(determined,
                [&](int p) { return !std::binary_search(touched.begin(), touched.end(), p); });
  Calibration calibration{problem->table(), {}};
  FreeSet columns(std::move(determined), calibration.table.size());
  calibration.steps.push_back(
      {step, SolveOptions{}.max_num_iterations, std::move(problem), std::move(columns), {}});
  return calibration;
}

}  // namespace kinecal
