// A lens that find_lenses() has tried, and whether its error on held-out samples is smaller than that of another.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// A mean, and whether it is above zero for certain.
class SureMean {
 public:
  void add(double value) {
    sum_ += value;
    squared_ += value * value;
    count_ += 1.0;
  }
  [[nodiscard]] bool is_positive() const {
    if (count_ < 3.0) return false;
    const double mean = sum_ / count_, variance = squared_ / count_ - mean * mean;
    // Chance is below 5 %: Student's t, to 2 % of its value.
    const double freedom = count_ - 1.0;
    const double sure = 1.645 * (1.0 + 1.0 / freedom + 1.1 / (freedom * freedom));
    return mean > sure * std::sqrt(std::max(0.0, variance) / freedom);
  }

 private:
  double sum_ = 0.0, squared_ = 0.0, count_ = 0.0;
};

/// A lens that was tried.
struct TriedLens {
  std::string name;
  std::string held;  ///< a coefficient that is zero and held; empty: none
  Config config;
  std::vector<Sample> samples;
  std::vector<double> squares = {};  ///< held_out_squares()
  std::string fault = {};            ///< why it is out; empty: it is not
  bool is_wrong_input = false;       ///< the fault is an error with its place, not one of this lens
  std::string unknown = {};          ///< a parameter that the samples do not determine; empty: none
  std::string hardly = {};           ///< a parameter that the samples hardly determine; empty: none

  /// "plumb_bob without k3"
  [[nodiscard]] std::string text() const { return held.empty() ? name : name + " without " + held; }
  /// Root of the mean of the squared distances of features, pixels.
  [[nodiscard]] double error() const {
    double sum = 0.0, count = 0.0;
    for (const double square : squares) {
      sum += square;
      count += square > 0.0 ? 1.0 : 0.0;
    }
    return count > 0.0 ? std::sqrt(2.0 * sum / count) : 0.0;  // of both coordinates
  }
  /// True if its error is significantly smaller than that of another one: by the differences of mean squares, or by
  /// their ratios, which one view that is far off under the other lens does not blur.
  [[nodiscard]] bool beats(const TriedLens& other) const {
    if (!(error() < other.error())) return false;
    SureMean differences, ratios;
    for (std::size_t s = 0; s < squares.size(); ++s) {
      if (!(squares[s] > 0.0 && other.squares[s] > 0.0)) continue;
      differences.add(other.squares[s] - squares[s]);
      ratios.add(std::log(other.squares[s] / squares[s]));
    }
    return differences.is_positive() || ratios.is_positive();
  }
};

/// "plumb_bob 22.7 px, equidistant 0.84 px, double_sphere: folds over"
[[nodiscard]] inline std::string errors_text(const std::vector<TriedLens>& tried) {
  std::string text;
  for (const TriedLens& lens : tried) {
    text += text.empty() ? "" : ", ";
    text += lens.fault.empty() ? fmt::format("{} {:.4g} px", lens.text(), lens.error())
                               : fmt::format("{}: {}", lens.text(), lens.fault);
    if (!lens.hardly.empty()) text += fmt::format(" (hardly determines {})", lens.hardly);
  }
  return text;
}

/// Reports why no lens fits: what is wrong with the views, if some lens says it.
inline void report_faults(const ModelConfig& camera, const std::vector<TriedLens>& tried,
                          Diagnostics& diagnostics) {
  const auto wrong = std::find_if(tried.begin(), tried.end(),
                                  [](const TriedLens& lens) { return lens.is_wrong_input; });
  if (wrong != tried.end()) {
    diagnostics.errors.push_back(wrong->fault);
    return;
  }
  const bool is_flat = std::any_of(tried.begin(), tried.end(), [&](const TriedLens& lens) {
    return lens.unknown == parameter_name(camera.param_name, "fx") ||
           lens.unknown == parameter_name(camera.param_name, "fy");
  });
  const bool is_same = std::all_of(tried.begin(), tried.end(), [&](const TriedLens& lens) {
    return lens.fault == tried.front().fault;
  });
  const std::string faults = is_same ? tried.front().fault : errors_text(tried);
  diagnostics.error(
      camera.place,
      is_flat ? fmt::format("these views do not tell the focal length of '{}': tilt the target by "
                            "30 degrees to all sides ({})",
                            camera.name, faults)
              : fmt::format("sensor '{}': no lens fits ({}); are the columns, rows and ids of the "
                            "target right?",
                            camera.name, faults));
}

}  // namespace kinecal::detail
