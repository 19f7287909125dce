// Writing base_calibration.yaml.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/base_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "kinecal/errors/base_motion.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

namespace detail {
namespace {

/// With twelve digits, as many as Python 2 prints: Fetch's installer copies them.
[[nodiscard]] std::string twelve_digits(double value) {
  return number_to_yaml(number_from_yaml(fmt::format("{:.12g}", value)).value_or(value));
}

/// What the driver should have instead of what it has, with its key in ROS 1.
/// @param own      parameters of the error block, by name
/// @param drivers  what it has, by error block
/// @param open     of own: scales that the samples do not determine; the driver keeps what it has
[[nodiscard]] std::optional<std::pair<std::string, double>> of_ros1(
    const Term& term, const std::map<std::string, double>& own,
    const std::map<std::string, double>& drivers, const std::set<std::string>& open) {
  if (!open.empty()) return std::nullopt;
  const auto has = drivers.find(term.name);
  if (has == drivers.end() || !(has->second > 0.0)) return std::nullopt;
  if (term.options.type.starts_with("gyro")) return std::pair("imu", has->second * own.at("scale"));
  double rollout = own.at("rollout_scale");
  if (own.count("left_rollout_scale") > 0) {
    rollout *= 0.5 * (own.at("left_rollout_scale") + own.at("right_rollout_scale"));
  }
  return std::pair("odom", has->second * own.at("track_width_scale") / rollout);
}

}  // namespace
}  // namespace detail

std::string base_calibration_yaml(const Calibration& calibration, const ParameterTable& table,
                                  const std::map<int, double>& deviations,
                                  const std::map<std::string, double>& drivers) {
  std::string text;
  std::set<std::string> keys;
  for (const CalibrationStep& step : calibration.steps) {
    for (int t = 0; t < step.problem->num_terms(); ++t) {
      const Term& term = step.problem->term(t);
      if (!is_base_type(term.options.type)) continue;
      const std::string prefix = term.options.type.starts_with("gyro") ? "imu_" : "";
      std::map<std::string, double> own;
      std::set<std::string> open;
      for (const int index : term.parameters) {
        const std::string name = table[index].name.substr(term.name.size() + 1);
        own[name] = table[index].value;
        if (name == "x" || name == "y" || name == "yaw" || !keys.insert(prefix + name).second) {
          continue;
        }
        const auto deviation = deviations.find(index);
        const bool is_free = deviation != deviations.end();
        if (is_free && !std::isfinite(deviation->second)) {  // any value would do
          if (table[index].unit == "1") open.insert(name);
          text += fmt::format("# {}{}: not determined\n", prefix, name);
          continue;
        }
        text += fmt::format("{}{}: {}", prefix, name, number_to_yaml(table[index].value));
        if (is_free) text += fmt::format("  # +- {:.2g}", deviation->second);
        text += "\n";
      }
      const auto ros1 = detail::of_ros1(term, own, drivers, open);
      if (ros1 && keys.insert(ros1->first).second) {
        text += fmt::format("{}: {}\n", ros1->first, detail::twelve_digits(ros1->second));
      }
    }
  }
  return text;
}

}  // namespace kinecal
