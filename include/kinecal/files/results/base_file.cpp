// Writing base_calibration.yaml.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/base_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <string_view>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

std::string base_calibration_yaml(const Calibration& calibration, const ParameterTable& table,
                                  const std::map<int, double>& deviations) {
  std::string text;
  std::set<std::string> keys;
  for (const CalibrationStep& step : calibration.steps) {
    for (int t = 0; t < step.problem->num_terms(); ++t) {
      const Term& term = step.problem->term(t);
      if (!is_base_type(term.options.type)) continue;
      const std::string prefix = term.options.type.starts_with("gyro") ? "imu_" : "";
      for (const int index : term.parameters) {
        const std::string name = table[index].name.substr(term.name.size() + 1);
        if (name == "x" || name == "y" || name == "yaw" || !keys.insert(prefix + name).second) {
          continue;
        }
        text += fmt::format("{}{}: {}", prefix, name, number_to_yaml(table[index].value));
        if (const auto deviation = deviations.find(index); deviation != deviations.end()) {
          text += std::isfinite(deviation->second) ? fmt::format("  # +- {:.2g}", deviation->second)
                                                   : "  # not determined";
        }
        text += "\n";
      }
    }
  }
  return text;
}

}  // namespace kinecal
