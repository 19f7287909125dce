// A lens that find_lenses() has tried, and whether its error on held-out samples is smaller than that of another.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
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
  std::vector<double> squares;  ///< held_out_squares()
  std::string fault;            ///< why it is out; empty: it is not
  std::string hardly;           ///< a parameter that the samples hardly determine; empty: none

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

}  // namespace kinecal::detail
