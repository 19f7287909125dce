// Writing the report as JSON.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "kinecal/report/json.hpp"

namespace kinecal {

namespace detail {

KINECAL_INLINE std::string json_string(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      json += '\\';
      json += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      json += fmt::format("\\u{:04x}", static_cast<int>(c));
    } else {
      json += c;
    }
  }
  return json + "\"";
}

KINECAL_INLINE std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

[[nodiscard]] inline std::string json(const Statistics& s) {
  return fmt::format(R"({{"rms": {}, "mean": {}, "median": {}, "max": {}}})", json_number(s.rms),
                     json_number(s.mean), json_number(s.median), json_number(s.max));
}

[[nodiscard]] inline std::string json(const StepResult& step) {
  return fmt::format(
      R"({{"name": {}, "iterations": {}, "initial_cost": {}, "final_cost": {}, "seconds": {}, )"
      R"("num_residuals": {}, "num_parameters": {}, "form": {}}})",
      json_string(step.name), step.iterations, json_number(step.initial_cost),
      json_number(step.final_cost), json_number(step.seconds), step.num_residuals,
      step.num_parameters, json_string(to_string(step.form)));
}

[[nodiscard]] inline std::string json(const BlockStatistics& block) {
  return fmt::format(
      R"({{"name": {}, "type": {}, "unit": {}, "count": {}, "before": {}, "after": {}}})",
      json_string(block.name), json_string(block.type), json_string(block.unit), block.count,
      json(block.before), json(block.after));
}

[[nodiscard]] inline std::string json(const Parameter& parameter) {
  return fmt::format(R"({{"name": {}, "value": {}, "initial": {}, "unit": {}}})",
                     json_string(parameter.name), json_number(parameter.value),
                     json_number(parameter.initial), json_string(parameter.unit));
}

[[nodiscard]] inline std::string json(const Observability& observability,
                                      const ParameterTable& table) {
  std::string combinations;
  for (const Combination& combination : observability.unobservable) {
    std::string factors;
    for (const auto& [parameter, factor] : combination) {
      factors += fmt::format("{}{}: {}", factors.empty() ? "" : ", ",
                             json_string(table[parameter].name), json_number(factor));
    }
    combinations += fmt::format("{}{{{}}}", combinations.empty() ? "" : ", ", factors);
  }
  return fmt::format(R"({{"rank": {}, "condition": {}, "unobservable": [{}]}})", observability.rank,
                     json_number(observability.condition), combinations);
}

/// "[\n    a,\n    b\n  ]"
template <class Items, class Write>
[[nodiscard]] std::string json_list(const Items& items, Write&& write) {
  std::string list;
  for (const auto& item : items) list += (list.empty() ? "\n    " : ",\n    ") + write(item);
  return list.empty() ? "[]" : "[" + list + "\n  ]";
}

}  // namespace detail

KINECAL_INLINE std::string json_report(const CalibrationResult& result,
                                       const std::vector<Observability>& observability) {
  const auto write = [](const auto& item) { return detail::json(item); };
  return fmt::format(
      "{{\n  \"converged\": {},\n  \"termination\": {},\n  \"steps\": {},\n"
      "  \"error_blocks\": {},\n  \"parameters\": {},\n  \"observability\": {}\n}}\n",
      result.converged, detail::json_string(result.termination),
      detail::json_list(result.steps, write), detail::json_list(result.blocks, write),
      detail::json_list(result.calibrated, [&](int i) { return detail::json(result.table[i]); }),
      detail::json_list(observability,
                        [&](const auto& item) { return detail::json(item, result.table); }));
}

}  // namespace kinecal
