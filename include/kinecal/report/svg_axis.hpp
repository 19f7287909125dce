// An axis of a chart: maps values to coordinates, and places ticks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace kinecal::detail {

/// A tick.  Those between decades of a logarithmic axis may have no label.
struct Tick {
  double value = 0.0;
  std::string label;
};

/// x = from + (to - from) (f(v) - f(low)) / (f(high) - f(low)), where f is v or log10 v.
class Axis {
 public:
  /// Ends at round values that include `low` and `high`.  Equal or non-finite values get a range
  /// around them.
  /// @param from, to  coordinates of the ends; to < from on axes that point up
  [[nodiscard]] static Axis linear(double low, double high, double from, double to);
  /// The same without rounding the ends.
  [[nodiscard]] static Axis exact(double low, double high, double from, double to);
  /// The same for logarithms, at least one decade.  Replaces values that are not positive.
  [[nodiscard]] static Axis logarithmic(double low, double high, double from, double to);

  /// Coordinate of a value; values beyond an end are at that end, also zero on a logarithmic axis.
  [[nodiscard]] double at(double value) const;
  /// Value at a coordinate.
  [[nodiscard]] double value(double coordinate) const;
  /// About `most` ticks at round values within the axis.
  [[nodiscard]] std::vector<Tick> ticks(int most = 6) const;

  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] double to() const { return to_; }

 private:
  Axis(double low, double high, double from, double to, bool logarithmic);

  double low_, high_, from_, to_;
  bool logarithmic_;
};

/// A round step, 1, 2 or 5 times a power of ten, that fits about `most` times into a range.
[[nodiscard]] double round_step(double range, int most);

}  // namespace kinecal::detail
