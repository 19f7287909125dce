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

/// A lens that was tried.
struct TriedLens {
  std::string name;
  Config config;
  std::vector<Sample> samples;
  std::vector<double> squares;  ///< held_out_squares()
  std::string fault;            ///< why it is out; empty: it is not

  /// Root of the mean of the squared distances of features, pixels.
  [[nodiscard]] double error() const {
    double sum = 0.0, count = 0.0;
    for (const double square : squares) {
      sum += square;
      count += square > 0.0 ? 1.0 : 0.0;
    }
    return count > 0.0 ? std::sqrt(2.0 * sum / count) : 0.0;  // of both coordinates
  }
  /// True if its error is significantly smaller than that of another one.
  [[nodiscard]] bool beats(const TriedLens& other) const {
    double sum = 0.0, squared = 0.0, count = 0.0;
    for (std::size_t s = 0; s < squares.size(); ++s) {
      if (!(squares[s] > 0.0 && other.squares[s] > 0.0)) continue;
      const double d = other.squares[s] - squares[s];
      sum += d;
      squared += d * d;
      count += 1.0;
    }
    if (count < 3.0) return false;
    const double mean = sum / count, variance = squared / count - mean * mean;
    constexpr double kSure = 1.645;  // standard errors: chance is below 5 %
    return mean > kSure * std::sqrt(std::max(0.0, variance) / (count - 1.0));
  }
};

}  // namespace kinecal::detail
