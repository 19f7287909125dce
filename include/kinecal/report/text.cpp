// Writing the report as text.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/shell_command.hpp"

namespace kinecal {

std::string TextTable::str() const {
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

std::string in_reading_unit(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "-";
  return unit == "m" ? fmt::format("{:.3f}", 1e3 * value) : fmt::format("{:.4g}", value);
}

std::string reading_unit(const std::string& unit) {
  return unit == "m" ? "mm" : unit == "1" ? "-" : unit;
}

std::string design_effect_note(const Assessment& of) {
  const double effect = of.uncertainty.design_effect, readings = of.readings;
  if (effect <= 1.0) return "";
  constexpr double kRepeated = 1.2;
  if (of.uncertainty.by_links) {
    return fmt::format(
        "  Features of one link err together, as if it were not quite its mesh: +- are {:.1f} "
        "times as\n"
        "  large as if they erred independently\n",
        std::sqrt(effect));
  }
  if (const int alike = of.neighbours.together; alike > 1) {
    return fmt::format(
        "  Residuals of consecutive samples are alike, so {} poses count as one: +- are {:.1f} "
        "times as\n"
        "  large as if they erred independently; record poses in a random order\n",
        alike, std::sqrt(effect));
  }
  if (readings > kRepeated) {
    return fmt::format(
        "  Each pose was read {:.1f} times in the mean, and readings of a pose err together: +- "
        "are {:.1f}\n"
        "  times as large as if they erred independently; other poses say more\n",
        readings, std::sqrt(effect));
  }
  return fmt::format(
      "  Features of one sample err together, as if joints did not repeat: +- are {:.1f} times as\n"
      "  large as if they erred independently\n",
      std::sqrt(effect));
}

namespace detail {

/// "1.234 deg", "5.678 mm", "0.910 %", "2.5 ms" or "1.2e-05 rad/Nm".
std::pair<std::string, std::string> for_people(double value, const std::string& unit) {
  if (unit == "rad") return {fmt::format("{:.3f}", value * 180.0 / std::numbers::pi), "deg"};
  if (unit == "m") return {fmt::format("{:.3f}", 1e3 * value), "mm"};
  if (unit == "1") return {fmt::format("{:.3f}", 1e2 * value), "%"};
  if (unit == "s") return {fmt::format("{:.3f}", 1e3 * value), "ms"};
  return {fmt::format("{:.3g}", value), unit};
}

}  // namespace detail

std::string step_lines(const CalibrationResult& result) {
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

std::string solving_text(const CalibrationResult& result) {
  double seconds = 0.0, samples = 0.0;
  int iterations = 0;
  std::string form;  // named only if it is not the default
  for (const StepResult& step : result.steps) {
    seconds += step.seconds;
    samples += static_cast<double>(step.samples) * step.evaluations;
    iterations += step.iterations;
    if (step.form != CostForm::compressed) form = fmt::format(", {} cost", to_string(step.form));
  }
  const std::string iterated = counted(static_cast<std::size_t>(iterations), "iteration");
  const std::string_view set = evaluation_of_library().instruction_set;
  if (iterations == 0 || !(seconds > 0.0)) {
    return fmt::format("solving {:.4f} s ({}, {}{})", seconds, iterated, set, form);
  }
  return fmt::format("solving {:.4f} s ({}, {:.3g} million samples a second, {}{})", seconds,
                     iterated, 1e-6 * samples / seconds, set, form);
}

std::string observability_text(const std::string& step, const Observability& observability,
                               const ParameterTable& table) {
  if (observability.unobservable.empty()) return {};
  const std::size_t unknown = observability.unobservable.size();
  std::string text =
      fmt::format("step '{}': {} of {} parameters cannot be determined from these samples\n", step,
                  unknown, static_cast<std::size_t>(observability.rank) + unknown);
  if (!observability.hold.empty()) {
    std::vector<std::string> names;
    for (const int parameter : observability.hold) names.push_back(table[parameter].name);
    text += "  to determine the others, hold: " + ShellCommand().add_names("--hold", names).str() +
            "\n";
  }
  text += "  no residual changes along:\n";
  constexpr std::size_t kCombinations = 4, kParameters = 3;
  for (std::size_t c = 0; c < std::min(kCombinations, unknown); ++c) {
    const Combination& combination = observability.unobservable[c];
    text += "   ";
    for (std::size_t i = 0; i < std::min(kParameters, combination.size()); ++i) {
      const auto& [parameter, factor] = combination[i];
      text += fmt::format(" {:+.3g} {}", factor, table[parameter].name);
    }
    text += combination.size() > kParameters ? " ...\n" : "\n";
  }
  if (unknown > kCombinations) text += fmt::format("    and {} more\n", unknown - kCombinations);
  return text;
}

}  // namespace kinecal
