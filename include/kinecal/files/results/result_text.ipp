// The names of a result's files, and the values in calibration.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::detail {

/// "depth_camera.yaml"; with a date "depth_<date>.yaml", without the name "camera".
[[nodiscard]] inline std::string camera_file(const char* kind, const std::string& camera,
                                             const std::string& date) {
  std::string name = camera;
  std::replace(name.begin(), name.end(), '/', '_');
  if (date.empty()) return fmt::format("{}_{}.yaml", kind, name);
  return fmt::format("{}_{}{}.yaml", kind, name == "camera" ? "" : name + "_", date);
}

/// "calibrated.urdf", or with a date "calibrated_<date>.urdf".
[[nodiscard]] inline std::string dated(const char* stem, const char* ending,
                                       const std::string& date) {
  return date.empty() ? fmt::format("{}{}", stem, ending)
                      : fmt::format("{}_{}{}", stem, date, ending);
}

/// Lines `name: value` for the parameters that some step freed, and for those held at nonzero
/// values.  Standard deviations are comments.
[[nodiscard]] inline std::string values_yaml(const CalibrationResult& result,
                                             const std::map<int, double>& deviations) {
  std::string text;
  for (int i = 0; i < result.table.size(); ++i) {
    const auto& freed = result.calibrated;
    const bool calibrated = std::find(freed.begin(), freed.end(), i) != freed.end();
    if (!calibrated && result.table[i].value == 0.0) continue;
    text += fmt::format("{}: {}", name_to_yaml(result.table[i].name),
                        number_to_yaml(result.table[i].value));
    const auto deviation = deviations.find(i);
    if (deviation == deviations.end()) {
      text += "\n";
    } else if (std::isfinite(deviation->second)) {
      text += fmt::format("  # +- {:.2g}\n", deviation->second);
    } else {
      text += "  # not determined\n";
    }
  }
  return text;
}

}  // namespace kinecal::detail
