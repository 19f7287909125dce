// Solves a calibration with a mistake undone, and describes the change.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/assemble.hpp"
#include "kinecal/config/doubts/likely_causes.hpp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/trust/judge_noise.ipp"

namespace kinecal::detail {

/// A solved calibration: its cost, its error blocks and all parameters.
struct SolvedSamples {
  double cost = 0.0;
  std::vector<BlockStatistics> blocks;
  ParameterTable table;
  double size = 0.0;  ///< of the robot, metres
};

/// How to solve hypotheses.
struct CauseSolver {
  const Config& config;
  const Robot& robot;
  Calibrator solve;                      ///< calibrate(), or one with other starts
  const ParameterTable* from = nullptr;  ///< where it starts, instead of the initial values
};

/// Assembles; nullopt if these samples are unusable.
[[nodiscard]] inline std::optional<Calibration> assembled(const CauseSolver& solver,
                                                          const Config& config,
                                                          std::span<const Sample> samples) {
  constexpr int kEnough = 100;  // iterations; what fits is found in far fewer
  Diagnostics quiet;
  Calibration calibration = assemble(config, solver.robot, samples, quiet);
  for (CalibrationStep& step : calibration.steps) {
    step.max_num_iterations = std::min(step.max_num_iterations, kEnough);
    if (solver.from == nullptr) continue;
    step.unknown_frames.clear();
    step.assignments.clear();
  }
  for (int i = 0; solver.from != nullptr && i < calibration.table.size(); ++i) {
    calibration.begin.push_back((*solver.from)[calibration.table[i].name].value);
  }
  if (!quiet.errors.empty() || calibration.steps.empty()) return std::nullopt;
  return calibration;
}

/// Solves; nullopt if the fit is not finite.
[[nodiscard]] inline std::optional<SolvedSamples> solved(const CauseSolver& solver,
                                                         const Calibration& calibration) {
  const CalibrationResult result = solver.solve(calibration);
  if (result.steps.empty() || !std::isfinite(result.steps.back().final_cost)) return std::nullopt;
  return SolvedSamples{result.steps.back().final_cost, result.blocks, result.table,
                       robot_size(*calibration.steps.back().problem)};
}

/// Solves with other numbers in the samples; nullopt if they are unusable, or if the fit is not finite.
[[nodiscard]] inline std::optional<SolvedSamples> solved_with(const CauseSolver& solver,
                                                              const Calibration& calibration,
                                                              std::span<const Sample> samples) {
  try {
    return solved(solver, with_samples(calibration, samples));
  } catch (const SampleError&) {
    return std::nullopt;
  }
}

/// True if the typical distances of all error blocks are below those of a result that is refused.
[[nodiscard]] inline bool fits(const SolvedSamples& solved) {
  bool any = false;
  for (const BlockStatistics& block : solved.blocks) {
    if (block.unit != "m" && block.unit != "px") continue;
    any = true;
    if (!(block.after.median < distance_limits(block.unit, solved.size).refuse)) return false;
  }
  return any;
}

[[nodiscard]] inline Calibrator plain_calibrator() {
  return [](const Calibration& calibration) {
    return calibrate(calibration, {},
                     {.hold_undetermined = false});  // what samples determine is compared
  };
}

/// "the samples can be solved, and the mean residual of 'hand_eye' is 0.11 mm", for the first block.
[[nodiscard]] inline std::string solved_text(const SolvedSamples& after) {
  std::string text = "the samples can be solved";
  for (const BlockStatistics& block : after.blocks) {
    if (block.unit != "m" && block.unit != "px") continue;
    return text + fmt::format(", and the mean residual of '{}' is {}", block.name,
                              residual_text(block.after.mean, block.unit));
  }
  return text;
}

/// "the mean residual of 'hand_eye' falls from 93 mm to 0.11 mm", for the block that falls most;
/// for a prior only if no other falls.
[[nodiscard]] inline std::string fall_of(const SolvedSamples& before, const SolvedSamples& after) {
  std::string text = fmt::format("the cost falls from {:.3g} to {:.3g}", before.cost, after.cost);
  double most = 1.0;
  for (const BlockStatistics& block : before.blocks) {
    for (const BlockStatistics& same : after.blocks) {
      const double ratio = block.after.mean / std::max(same.after.mean, 1e-300);
      if (same.name != block.name || block.unit == "1" || !(ratio > most)) continue;
      most = ratio;
      text = fmt::format("the mean residual of '{}' falls from {} to {}", block.name,
                         residual_text(block.after.mean, block.unit),
                         residual_text(same.after.mean, same.unit));
    }
  }
  return text;
}

/// A mistake that explains the residuals.
struct Cause {
  double cost = 0.0;  ///< without it
  std::string sentence;
};

}  // namespace kinecal::detail
