// Writing the report as text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/evaluation/make_problem.hpp"
#include "kinecal/report/text.hpp"

namespace kinecal {

KINECAL_INLINE std::string TextTable::str() const {
  std::vector<std::size_t> widths(rows_.front().size(), 0);
  for (const Row& row : rows_) {
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], row[c].size());
  }
  std::string text;
  for (const Row& row : rows_) {
    std::string line = " ";
    for (std::size_t c = 0; c < row.size(); ++c) {
      line += c < left_columns_ ? fmt::format(" {:<{}}", row[c], widths[c])
                                : fmt::format("  {:>{}}", row[c], widths[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

KINECAL_INLINE std::string in_reading_unit(double value, const std::string& unit) {
  return unit == "m" ? fmt::format("{:.3f}", 1e3 * value) : fmt::format("{:.4g}", value);
}

KINECAL_INLINE std::string reading_unit(const std::string& unit) {
  return unit == "m" ? "mm" : unit == "1" ? "-" : unit;
}

namespace detail {

/// "1.234 deg", "5.678 mm" or "0.910 %".
[[nodiscard]] inline std::string for_people(double value, const std::string& unit) {
  if (unit == "rad") return fmt::format("{:.3f} deg", value * 180.0 / std::numbers::pi);
  if (unit == "m") return fmt::format("{:.3f} mm", 1e3 * value);
  return fmt::format("{:.3f} %", 1e2 * value);
}

}  // namespace detail

KINECAL_INLINE std::string error_block_table(const CalibrationResult& result) {
  TextTable table(
      {"error block", "features", "unit", "rms", "->", "", "median", "->", "", "max", "->", ""});
  for (const BlockStatistics& block : result.blocks) {
    const auto text = [&](double value) { return in_reading_unit(value, block.unit); };
    table.add({block.name, fmt::format("{}", block.count), reading_unit(block.unit),
               text(block.before.rms), "->", text(block.after.rms), text(block.before.median), "->",
               text(block.after.median), text(block.before.max), "->", text(block.after.max)});
  }
  return table.str();
}

KINECAL_INLINE std::string parameter_table(const CalibrationResult& result) {
  TextTable table({"parameter", "calibrated", "value", "from"});
  for (const int i : result.calibrated) {
    const Parameter& parameter = result.table[i];
    const std::string pad = parameter.unit == "1" ? "  " : parameter.unit == "m" ? " " : "";
    table.add({parameter.name, detail::for_people(parameter.value, parameter.unit) + pad,
               fmt::format("{:.8g}", parameter.value), fmt::format("{:.8g}", parameter.initial)});
  }
  return table.str();
}

KINECAL_INLINE std::string step_lines(const CalibrationResult& result) {
  std::string text;
  for (const StepResult& step : result.steps) {
    text += fmt::format(
        "  {}: {} parameters, {} residuals, cost {:.6g} -> {:.6g} in {} iterations "
        "({:.1f} ms)\n    {}\n",
        step.name, step.num_parameters, step.num_residuals, step.initial_cost, step.final_cost,
        step.iterations, 1e3 * step.seconds, step.termination);
  }
  return text;
}

KINECAL_INLINE std::string solving_text(const CalibrationResult& result) {
  double seconds = 0.0, samples = 0.0;
  int iterations = 0;
  std::string form;  // named only if it is not the default
  for (const StepResult& step : result.steps) {
    seconds += step.seconds;
    samples += static_cast<double>(step.samples) * step.evaluations;
    iterations += step.iterations;
    if (step.form != CostForm::compressed) form = fmt::format(", {} cost", to_string(step.form));
  }
  const double millions_a_second = seconds > 0.0 ? 1e-6 * samples / seconds : 0.0;
  return fmt::format("solving {:.4f} s ({} iterations, {:.3g} million samples a second, {}{})",
                     seconds, iterations, millions_a_second,
                     evaluation_of_library().instruction_set, form);
}

KINECAL_INLINE std::vector<std::string> active_bounds(const Calibration& calibration,
                                                      const CalibrationResult& result) {
  std::vector<std::string> lines;
  for (const CalibrationStep& step : calibration.steps) {
    for (const int p : step.free.parameters()) {
      const Parameter& parameter = step.problem->table()[p];
      const double value = result.table[p].value;
      constexpr double kAtBound = 1e-9;
      const double near = kAtBound * (1e-3 + std::abs(value));
      if (value > parameter.lower + near && value < parameter.upper - near) continue;
      lines.push_back(
          fmt::format("step '{}': '{}' ended at its bound {}", step.name, parameter.name, value));
    }
  }
  return lines;
}

KINECAL_INLINE std::string observability_text(const std::string& step,
                                              const Observability& observability,
                                              const ParameterTable& table) {
  if (observability.unobservable.empty()) return {};
  const std::size_t unknown = observability.unobservable.size();
  std::string text = fmt::format(
      "step '{}': {} of {} parameter combinations are observable from these samples; along the "
      "other{} "
      "no residual changes, and priors or initial values decide",
      step, observability.rank, static_cast<std::size_t>(observability.rank) + unknown,
      unknown == 1 ? "" : "s");
  for (const Combination& combination : observability.unobservable) {
    text += "\n   ";
    constexpr std::size_t kListed = 6;
    for (std::size_t i = 0; i < std::min(kListed, combination.size()); ++i) {
      const auto& [parameter, factor] = combination[i];
      text += fmt::format(" {:+.3g} {}", factor, table[parameter].name);
    }
    if (combination.size() > kListed) text += " ...";
  }
  return text;
}

KINECAL_INLINE std::vector<std::string> suspicious_values(const CalibrationResult& result) {
  std::vector<std::string> lines;
  for (const int i : result.calibrated) {
    const Parameter& parameter = result.table[i];
    const double change = std::abs(parameter.value - parameter.initial);
    const bool depth = parameter.name.ends_with("_z_offset");
    const double limit = parameter.unit == "rad" ? 0.5
                         : parameter.unit == "m" ? (depth ? 0.1 : 0.2)
                                                 : 0.2;
    if (change <= limit) continue;
    lines.push_back(fmt::format(
        "'{}' changed by {}: is the URDF or the initial value wrong, or do "
        "these samples not determine it?",
        parameter.name, detail::for_people(parameter.value - parameter.initial, parameter.unit)));
  }
  return lines;
}

}  // namespace kinecal
