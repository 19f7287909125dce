// Definitions of calibrated_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/procedure/calibrated_files.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "kinecal/report/json.hpp"
#include "kinecal/report/residuals_csv.hpp"

namespace kinecal {

namespace detail {
namespace {

/// What the driver of a base has, by error block.
[[nodiscard]] std::map<std::string, double> drivers_of(const std::optional<Config>& config) {
  std::map<std::string, double> drivers;
  if (!config) return drivers;
  for (const StepConfig& step : config->steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const bool is_drive =
          block.type.starts_with("odometry_to_") || block.type.starts_with("differential_to_");
      if (!is_drive && !block.type.starts_with("gyro_to_")) continue;
      const auto has = block.numbers.find(is_drive ? "track_width" : "gyro_scale");
      if (has != block.numbers.end()) drivers.emplace(block.name, has->second);
    }
  }
  return drivers;
}

/// The URDF, calibration.yaml and camera files.
[[nodiscard]] std::vector<OutputFile> robot_files_of(const CalibratedRobot& calibrated,
                                                     ResultFileOptions options) {
  const PreparedCalibration& setup = calibrated.setup;
  const Findings& findings = calibrated;
  if (setup.urdf_text.empty()) {
    throw InputError(setup.urdf +
                     ": its text is not known, so a calibrated URDF cannot be written");
  }
  for (const int i : findings.result.calibrated) {
    if (const auto deviation = findings.deviation(i)) options.deviations[i] = *deviation;
  }
  options.drivers = drivers_of(setup.config);
  return result_files(setup.robot, setup.urdf_text, setup.urdf, setup.calibration, findings.result,
                      calibrated.samples, options);
}

}  // namespace
}  // namespace detail

std::vector<OutputFile> calibrated_files(const CalibratedRobot& calibrated,
                                         ResultFileOptions options,
                                         std::vector<OutputFile> others) {
  std::vector<OutputFile> files = detail::robot_files_of(calibrated, std::move(options));
  std::move(others.begin(), others.end(), std::back_inserter(files));
  OutputFile report{"report.json", json_report(calibrated, files)};
  files.push_back({"residuals.csv", residuals_csv(calibrated.setup.calibration, calibrated)});
  files.push_back(std::move(report));
  return files;
}

std::string calibrated_urdf(const CalibratedRobot& calibrated, const ResultFileOptions& options) {
  return detail::robot_files_of(calibrated, options).front().content;
}

}  // namespace kinecal
