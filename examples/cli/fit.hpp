// A calibration of the program: the procedure of the library, with the options of the command line.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal::cli {

/// A calibration and what was found.
struct Fit {
  Calibration calibration;
  std::vector<Sample> samples;   ///< those of the calibration
  std::vector<Sample> left_out;  ///< those of Findings::left_out
  Findings findings;
};

/// Calibrates and judges: see calibrate_and_judge().
/// @param calibration  of the input's samples
/// @throws InputError  if a sample to exclude does not exist, or too few are left
[[nodiscard]] Fit fit(const Input& input, Calibration calibration, const CalibrateOptions& options,
                      const Progress& progress, const SolveOptions& solving);

/// Which images the pixels of each camera are those of: "raw" or "rectified", where it was chosen.
[[nodiscard]] std::map<std::string, std::string> images_of(const Config& config);
/// The lens of each camera of raw images, as far as it is known.
[[nodiscard]] std::map<std::string, std::string> lenses_of(const Config& config);

}  // namespace kinecal::cli
