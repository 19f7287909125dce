// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include <fmt/core.h>

#include "kinecal/report.hpp"

namespace kinecal::cli {

std::vector<Observability> observe(const Calibration& calibration,
                                   const CalibrationResult& result) {
  const Eigen::VectorXd values = result.table.values();
  std::vector<Observability> all;
  for (const CalibrationStep& step : calibration.steps) {
    all.push_back(observability(*step.problem, step.free,
                                {values.data(), static_cast<std::size_t>(values.size())}));
  }
  return all;
}

void print_result(const std::string& robot, std::size_t samples, const CalibrationResult& result) {
  fmt::print("Robot '{}', {} samples\n{}\n", robot, samples, step_lines(result));
  fmt::print("Error blocks, before -> after (rms of components; median and max of features)\n{}\n",
             error_block_table(result));
  fmt::print("Parameters\n{}\n", parameter_table(result));
}

void print_doubts(const Calibration& calibration, const CalibrationResult& result,
                  const std::vector<Observability>& observability) {
  for (std::size_t s = 0; s < observability.size(); ++s) {
    const std::string text =
        observability_text(calibration.steps[s].name, observability[s], result.table);
    if (!text.empty()) fmt::print(stderr, "warning: {}\n", text);
  }
  for (const std::string& line : active_bounds(calibration, result)) {
    fmt::print(stderr, "warning: {}\n", line);
  }
  for (const std::string& line : suspicious_values(result)) {
    fmt::print(stderr, "warning: {}\n", line);
  }
}

std::vector<OutputFile> output_files(const Robot& robot, const UrdfFile& urdf,
                                     const Calibration& calibration,
                                     const CalibrationResult& result,
                                     const std::vector<Observability>& observability,
                                     std::span<const Sample> samples,
                                     const ResultFileOptions& options) {
  std::vector<OutputFile> files =
      result_files(robot, urdf.text, urdf.name, calibration, result, samples, options);
  files.push_back({"report.json", json_report(result, observability)});
  return files;
}

void write(OutputFolder& folder, const std::vector<OutputFile>& files) {
  folder.write(files);
  for (const OutputFile& file : files) {
    fmt::print("wrote {}\n", (folder.path() / file.name).string());
  }
}

}  // namespace kinecal::cli
