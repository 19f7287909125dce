// The error that a calibration leaves even with exact measurements, and its cause.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/samples/progress_meter.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// The remaining error of the judged pose after calibrations of simulated robots with exact
/// measurements.
struct RemainingError {
  int robots = 0;                   ///< calibrated ones; 0: none could be simulated
  double position = 0.0;            ///< RMS of the robots, metres
  std::vector<std::string> priors;  ///< without them it is gone; empty if that does not help
  std::vector<std::string> held;    ///< held parameters with simulated errors: the cause
};

/// Calibrates drawn robots without noise.
/// @param set        the samples to calibrate with, by index
/// @param tolerated  metres; a cause is sought if more remains
/// @param meter      called for each calibration
[[nodiscard]] RemainingError remaining_error(const StudyInput& input, const std::vector<int>& set,
                                             double tolerated, const ProgressMeter& meter = {});

/// What remains, and why: a line.
[[nodiscard]] std::string remaining_text(const RemainingError& remaining);

}  // namespace kinecal::cli
