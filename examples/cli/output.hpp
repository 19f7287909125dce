// The files of a result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/result_files.hpp"

namespace kinecal::cli {

/// How the files are written that the user asked for.
[[nodiscard]] ResultFileOptions file_options(const ResultOptions& options, const Robot& robot);

/// Sets whose reading of these files is judged.
void judge_files_of(const ResultOptions& options, const Robot& robot,
                    CalibrationOptions& calibrating);

/// The files of a result, and copies of its URDF and configuration.
/// @throws OutputError  if one would replace an input, or may not be replaced
[[nodiscard]] std::vector<OutputFile> files_of(const ResultOptions& options,
                                               const InputTexts& texts,
                                               const CalibratedRobot& calibrated);

/// Writes all files or none, and prints their names.
/// @param force  replaces files that have appeared meanwhile
void write(OutputFolder& folder, const std::vector<OutputFile>& files, bool force);

}  // namespace kinecal::cli
