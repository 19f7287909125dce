// The files of a result.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/result_files.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal::cli {

/// A URDF as it was read.
struct UrdfFile {
  std::string name, text;
};

/// All files of a calibration: the results, report.json and residuals.csv.
[[nodiscard]] std::vector<OutputFile> output_files(const Robot& robot, const UrdfFile& urdf,
                                                   const Calibration& calibration,
                                                   const Findings& findings,
                                                   std::span<const Sample> samples,
                                                   ResultFileOptions options = {});

/// How the files are written that the user asked for.
[[nodiscard]] ResultFileOptions file_options(const ResultOptions& options, const Robot& robot);

/// The files of a result, and copies of its URDF and configuration.
/// @throws OutputError  if one would replace an input, or may not be replaced
[[nodiscard]] std::vector<OutputFile> with_copies(const ResultOptions& options, const Input& input,
                                                  std::vector<OutputFile> files);

/// Writes all files or none, and prints their names.
void write(OutputFolder& folder, const std::vector<OutputFile>& files);

}  // namespace kinecal::cli
