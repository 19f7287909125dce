// The report as text, for people: tables in millimetres, degrees and pixels.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/solve/calibrate.hpp"
#include "kinecal/trust/observability.hpp"

namespace kinecal {

/// A table: columns as wide as their widest cell, the first ones to the left, the others to the
/// right.
class TextTable {
 public:
  using Row = std::vector<std::string>;

  explicit TextTable(Row header, std::size_t left_columns = 1)
      : rows_{std::move(header)}, left_columns_(left_columns) {}

  void add(Row row) { rows_.push_back(std::move(row)); }

  [[nodiscard]] std::string str() const {
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

 private:
  std::vector<Row> rows_;
  std::size_t left_columns_;
};

namespace detail {

/// A residual in the unit that people read it in.
[[nodiscard]] inline std::string in_reading_unit(double value, const std::string& unit) {
  return unit == "m" ? fmt::format("{:.3f}", 1e3 * value) : fmt::format("{:.4g}", value);
}

[[nodiscard]] inline std::string reading_unit(const std::string& unit) {
  return unit == "m" ? "mm" : unit == "1" ? "-" : unit;
}

/// "1.234 deg", "5.678 mm" or "0.910 %".
[[nodiscard]] inline std::string for_people(double value, const std::string& unit) {
  if (unit == "rad") return fmt::format("{:.3f} deg", value * 180.0 / std::numbers::pi);
  if (unit == "m") return fmt::format("{:.3f} mm", 1e3 * value);
  return fmt::format("{:.3f} %", 1e2 * value);
}

}  // namespace detail

/// Each error block before and after: rms of its components, median and maximum of its features.
[[nodiscard]] inline std::string error_block_table(const CalibrationResult& result) {
  TextTable table(
      {"error block", "features", "unit", "rms", "->", "", "median", "->", "", "max", "->", ""});
  for (const BlockStatistics& block : result.blocks) {
    const auto text = [&](double value) { return detail::in_reading_unit(value, block.unit); };
    table.add({block.name, fmt::format("{}", block.count), detail::reading_unit(block.unit),
               text(block.before.rms), "->", text(block.after.rms), text(block.before.median), "->",
               text(block.after.median), text(block.before.max), "->", text(block.after.max)});
  }
  return table.str();
}

/// Each calibrated parameter: its value for people and as it is.
[[nodiscard]] inline std::string parameter_table(const CalibrationResult& result) {
  TextTable table({"parameter", "calibrated", "value", "from"});
  for (const int i : result.calibrated) {
    const Parameter& parameter = result.table[i];
    const std::string pad = parameter.unit == "1" ? "  " : parameter.unit == "m" ? " " : "";
    table.add({parameter.name, detail::for_people(parameter.value, parameter.unit) + pad,
               fmt::format("{:.8g}", parameter.value), fmt::format("{:.8g}", parameter.initial)});
  }
  return table.str();
}

/// One line for each step: what it did and why it stopped.
[[nodiscard]] inline std::string step_lines(const CalibrationResult& result) {
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

/// What solving took, all steps together, and with what:
/// "solving 0.0006 s (4 iterations, 1.2 million samples a second, x86-64-v4)".
[[nodiscard]] inline std::string solving_text(const CalibrationResult& result) {
  double seconds = 0.0, samples = 0.0;
  int iterations = 0;
  std::string form;  // told only where it is not the usual one
  for (const StepResult& step : result.steps) {
    seconds += step.seconds;
    samples += static_cast<double>(step.samples) * step.evaluations;
    iterations += step.iterations;
    if (step.form != CostForm::compressed) form = fmt::format(", {} cost", to_string(step.form));
  }
  const double millions_a_second = seconds > 0.0 ? 1e-6 * samples / seconds : 0.0;
  return fmt::format("solving {:.4f} s ({} iterations, {:.3g} million samples a second, {}{})",
                     seconds, iterations, millions_a_second, instruction_set(), form);
}

/// Parameters that ended at a bound of their step.
[[nodiscard]] inline std::vector<std::string> active_bounds(const Calibration& calibration,
                                                            const CalibrationResult& result) {
  std::vector<std::string> lines;
  for (const CalibrationStep& step : calibration.steps) {
    for (const int p : step.free.parameters()) {
      const Parameter& parameter = step.problem.table()[p];
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

/// What the samples of a step cannot tell, a combination of parameters a line; empty if they tell
/// all.
[[nodiscard]] inline std::string observability_text(const std::string& step,
                                                    const Observability& observability,
                                                    const ParameterTable& table) {
  if (observability.unobservable.empty()) return {};
  const std::size_t unknown = observability.unobservable.size();
  std::string text = fmt::format(
      "step '{}': these samples tell {} of {} combinations of the parameters; along the other{} no "
      "residual changes, and priors or initial values decide",
      step, observability.rank, static_cast<std::size_t>(observability.rank) + unknown,
      unknown == 1 ? "" : "s");
  for (const Combination& combination : observability.unobservable) {
    text += "\n   ";
    constexpr std::size_t kTold = 6;
    for (std::size_t i = 0; i < std::min(kTold, combination.size()); ++i) {
      const auto& [parameter, factor] = combination[i];
      text += fmt::format(" {:+.3g} {}", factor, table[parameter].name);
    }
    if (combination.size() > kTold) text += " ...";
  }
  return text;
}

/// Values that no calibration should find: offsets of more than 0.5 rad, corrections of more than
/// 0.2 m, a depth offset of more than 0.1 m, intrinsics off by more than a fifth.
[[nodiscard]] inline std::vector<std::string> suspicious_values(const CalibrationResult& result) {
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
        "'{}' changed by {}: is the URDF or the initial value wrong, or can "
        "these samples not tell it?",
        parameter.name, detail::for_people(parameter.value - parameter.initial, parameter.unit)));
  }
  return lines;
}

}  // namespace kinecal
