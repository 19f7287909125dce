// What the program makes of a result: a report, warnings, files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/results/result_files.hpp"
#include "kinecal/trust/observability.hpp"

namespace kinecal::cli {

/// The observability of each step from its samples.
[[nodiscard]] std::vector<Observability> observe(const Calibration& calibration,
                                                 const CalibrationResult& result);

/// Prints steps, error blocks and parameters.
void print_result(const std::string& robot, std::size_t samples, const CalibrationResult& result);

/// Prints warnings about a result to the standard error stream.
void print_doubts(const Calibration& calibration, const CalibrationResult& result,
                  const std::vector<Observability>& observability);

/// A URDF as it was read.
struct UrdfFile {
  std::string name, text;
};

/// All files of a calibration: the results and the report.
[[nodiscard]] std::vector<OutputFile> output_files(const Robot& robot, const UrdfFile& urdf,
                                                   const Calibration& calibration,
                                                   const CalibrationResult& result,
                                                   const std::vector<Observability>& observability,
                                                   std::span<const Sample> samples,
                                                   const ResultFileOptions& options = {});

/// Writes all files or none, and prints their names.
void write(OutputFolder& folder, const std::vector<OutputFile>& files);

}  // namespace kinecal::cli
