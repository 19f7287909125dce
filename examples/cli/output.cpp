// SPDX-License-Identifier: Apache-2.0
#include "output.hpp"

#include <fmt/core.h>

#include "kinecal/report.hpp"
#include "terminal.hpp"

namespace kinecal::cli {

std::vector<OutputFile> output_files(const Robot& robot, const UrdfFile& urdf,
                                     const Calibration& calibration, const Findings& findings,
                                     std::span<const Sample> samples, ResultFileOptions options) {
  for (const int i : findings.result.calibrated) {
    if (const auto deviation = findings.deviation(i)) {
      options.deviations[i] = *deviation;
    }
  }
  std::vector<OutputFile> files =
      result_files(robot, urdf.text, urdf.name, calibration, findings.result, samples, options);
  files.push_back({"report.json", json_report(findings)});
  files.push_back({"residuals.csv", residuals_csv(calibration, findings)});
  return files;
}

void write(OutputFolder& folder, const std::vector<OutputFile>& files) {
  folder.write(files);
  for (const OutputFile& file : files) {
    say("wrote {}\n", (folder.path() / file.name).string());
  }
}

}  // namespace kinecal::cli
