// Drawing arrows.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/arrows.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/report/svg_text.hpp"

namespace kinecal::detail {

double arrow_times(const std::vector<double>& sorted, double pixel) {
  const double usual = quantile(sorted, 0.95);
  if (!(usual > 0.0)) return 1.0;
  const double most = kChartWidth / 16.0 / (pixel * usual);
  const double step = round_step(most, 1);
  return step > most * 1.5 ? 0.5 * step : step;
}

void append_arrow(std::string& path, ChartPoint from, ChartPoint to) {
  constexpr double kMost = 50.0;  // of what does not fit
  double x = to[0] - from[0], y = to[1] - from[1];
  const double length = std::hypot(x, y);
  if (length > kMost) {
    x *= kMost / length;
    y *= kMost / length;
  }
  const ChartPoint end = {from[0] + x, from[1] + y};
  path += "M" + coordinate(from[0]) + " " + coordinate(from[1]) + "L" + coordinate(end[0]) + " " +
          coordinate(end[1]);
  if (length < 3.0) return;
  const double size = std::min(4.5, 0.4 * length) / std::min(length, kMost);
  const auto wing = [&](double side) {
    return coordinate(end[0] - size * (x - 0.6 * side * y)) + " " +
           coordinate(end[1] - size * (y + 0.6 * side * x));
  };
  path += "M" + wing(1.0) + "L" + coordinate(end[0]) + " " + coordinate(end[1]) + "L" + wing(-1.0);
}

}  // namespace kinecal::detail
