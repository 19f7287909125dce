// The report of a calibration as a file: HTML to look at, or JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "study_input.hpp"

namespace kinecal::cli {

/// True for the name of a page: it ends in .html or .htm.
[[nodiscard]] bool is_page(const std::string& file);

/// All files that a calibration reads, by role ("URDF", "configuration", "samples", "camera").
[[nodiscard]] std::vector<std::pair<std::string, std::string>> read_files(
    const CalibrateOptions& options, const InputTexts& texts);

/// The inputs of a study or plan, and the command that repeats it: a section of its page.
[[nodiscard]] std::string study_inputs(const StudyInput& input);

/// Checks that no report would replace an input of the calibration.
/// @throws OutputError  if one would
void check_reports(const CalibrateOptions& options);

/// Writes the reports that the options ask for: pages or JSON.
/// @throws OutputError  naming the file
void write_reports(const CalibrateOptions& options, const InputTexts& texts,
                   const CalibratedRobot& calibrated);

}  // namespace kinecal::cli
