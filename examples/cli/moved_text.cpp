// SPDX-License-Identifier: Apache-2.0
#include "moved_text.hpp"

#include <fmt/core.h>

#include <cmath>

#include "kinecal/config/configured_sensor.hpp"
#include "kinecal/text/reading.hpp"

namespace kinecal::cli {

std::string mover_name(const StoredResult& result, const std::string& owner, bool is_frame) {
  bool is_sensor = false;
  for (const StepConfig& step : result.config.steps) {
    for (const ModelConfig& model : step.models) {
      is_sensor = is_sensor || detail::mount_from(model).parameter_prefix() == owner;
    }
  }
  const char* const kind = is_frame                        ? "frame"
                           : result.robot.has_joint(owner) ? "joint"
                           : is_sensor                     ? "sensor"
                                                           : "error block";
  return fmt::format("{} '{}'", kind, owner);
}

NamedChange named_change(const Mover& mover, const ParameterTable& table) {
  NamedChange named{mover.owner, mover.is_frame, {}, {}, mover.change, mover.deviation};
  for (const int parameter : mover.parameters) {
    named.parameters.push_back(table[parameter].name);
    named.units.push_back(table[parameter].unit);
  }
  return named;
}

std::string change_text(const NamedChange& of, const std::string& per) {
  std::vector<std::pair<double, double>> lengths, angles;
  std::string text;
  for (std::size_t i = 0; i < of.parameters.size(); ++i) {
    const std::string& unit = of.units[i];
    if (of.is_frame) {
      (unit == "m" ? lengths : angles).emplace_back(of.change[i], of.deviation[i]);
      continue;
    }
    text += fmt::format("{}{}{}{} +- {}", text.empty() ? "" : ", ",
                        of.parameters[i] == of.owner ? "" : of.parameters[i] + " ",
                        reading(of.change[i], unit), per, reading(of.deviation[i], unit));
  }
  if (!lengths.empty()) text += length_text(lengths, "m", per);
  if (!angles.empty()) text += (text.empty() ? "" : ", ") + length_text(angles, "rad", per);
  return text;
}

std::string length_text(const std::vector<std::pair<double, double>>& changes, const char* unit,
                        const std::string& per) {
  double length = 0.0, variance = 0.0;
  for (const auto& [change, deviation] : changes) length += change * change;
  length = std::sqrt(length);
  for (const auto& [change, deviation] : changes) {
    const double share = length > 0.0 ? change / length : 1.0;
    variance += share * share * deviation * deviation;
  }
  return reading(length, unit) + per + " +- " + reading(std::sqrt(variance), unit);
}

std::string chance_text(double probability) {
  constexpr double kLeast = 1e-6;
  return probability < kLeast ? "p < 1e-6" : fmt::format("p = {:.2g}", probability);
}

}  // namespace kinecal::cli
