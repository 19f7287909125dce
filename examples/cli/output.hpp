// What a calibration gives back to people: a report, doubts, files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/io/results/result_files.hpp"
#include "kinecal/trust/observability.hpp"

namespace kinecal::cli {

/// What the samples of each step tell.
[[nodiscard]] std::vector<Observability> observe(const Calibration& calibration,
                                                 const CalibrationResult& result);

/// Prints what was done: steps, error blocks, parameters.
void print_result(const std::string& robot, std::size_t samples, const CalibrationResult& result);

/// Prints to the standard error stream what may be wrong with a result.
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

/// Writes them, all or none, and says so.
void write(OutputFolder& folder, const std::vector<OutputFile>& files);

}  // namespace kinecal::cli
