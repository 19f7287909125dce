// Writing magnetometer_calibration.yaml.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/magnetometer_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "kinecal/errors/magnetic_field.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The first error block of a magnetometer; nullptr if there is none.
[[nodiscard]] const Term* magnetometer_term(const Calibration& calibration) {
  for (const CalibrationStep& step : calibration.steps) {
    for (int t = 0; t < step.problem->num_terms(); ++t) {
      const Term& term = step.problem->term(t);
      if (term.options.type == MagneticField::kType) return &term;
    }
  }
  return nullptr;
}

}  // namespace
}  // namespace detail

std::string magnetometer_yaml(const Calibration& calibration, const ParameterTable& table,
                              const std::map<int, double>& deviations) {
  constexpr double kTesla = 1e6;  // microtesla
  const Term* term = detail::magnetometer_term(calibration);
  if (term == nullptr) return "";
  const auto index = [&](const char* name) { return table.index(term->name + "_" + name); };
  const auto note = [&](int parameter, double unit) -> std::string {
    const auto deviation = deviations.find(parameter);
    if (deviation == deviations.end()) return "  # held";
    return std::isfinite(deviation->second) ? fmt::format("  # +- {:.2g}", deviation->second / unit)
                                            : "  # not determined";
  };
  std::string text;
  for (const char* name : {"bias_x", "bias_y", "bias_z", "field"}) {
    text += fmt::format("mag_{}: {}{}\n", name, number_to_yaml(table[index(name)].value / kTesla),
                        note(index(name), kTesla));
  }
  constexpr std::array<const char*, 9> kRows = {"xx", "xy", "xz", "xy", "yy",
                                                "yz", "xz", "yz", "zz"};
  std::vector<std::string> matrix;
  bool is_free = false;
  double largest = 0.0;
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    const int parameter = index(kRows[i]);
    const auto deviation = deviations.find(parameter);
    is_free = is_free || deviation != deviations.end() || table[parameter].value != 0.0;
    if (deviation != deviations.end()) largest = std::max(largest, deviation->second);
    matrix.push_back(number_to_yaml((i % 4 == 0 ? 1.0 : 0.0) + table[parameter].value));
  }
  if (!is_free) return text;
  return text + fmt::format("mag_soft_iron: [{}]  # {}\n", fmt::join(matrix, ", "),
                            std::isfinite(largest) ? fmt::format("+- {:.2g} or less", largest)
                                                   : "not all of it is determined");
}

}  // namespace kinecal
