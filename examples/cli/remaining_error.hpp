// What a calibration leaves of a robot's error even where nothing is measured wrongly, and why.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "study_input.hpp"

namespace kinecal::cli {

/// What calibrations of drawn robots leave of the pose that is judged, if nothing is measured wrongly.
struct RemainingError {
  int robots = 0;                   ///< that were calibrated; 0: none could be simulated
  double position = 0.0;            ///< RMS of the robots, metres
  std::vector<std::string> priors;  ///< without which it is gone; none if that does not help
  std::vector<std::string> held;  ///< parameters that are held, but simulated elsewhere: the cause
};

/// Calibrates drawn robots without noise.
/// @param set        the samples to calibrate with, by index
/// @param tolerated  metres; a cause is sought if more remains
[[nodiscard]] RemainingError remaining_error(const StudyInput& input, const std::vector<int>& set,
                                             double tolerated);

/// What remains, and why: a line.
[[nodiscard]] std::string remaining_text(const RemainingError& remaining);

}  // namespace kinecal::cli
