// Arrows in an image: their scale, and where they end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// From image pixels to the chart, with the enlargement of arrows.
struct ImageScale {
  ChartPoint corner = {0.0, 0.0};  ///< of the image in the chart
  ChartPoint low = {0.0, 0.0};     ///< of the image, pixels
  ChartPoint high = {1.0, 1.0};    ///< its other corner
  double pixel = 1.0;              ///< length of a pixel in the chart
  double times = 1.0;              ///< enlargement of arrows

  /// The end of an arrow; clipped to the image, give or take a few pixels.
  [[nodiscard]] ChartPoint end_of(const ReportedFeature& feature) const {
    const auto [x, y] = *feature.pixel;
    const auto within = [&](double v, std::size_t i) {
      const double room = 8.0 / pixel;
      return std::clamp(v, low[i] - room, high[i] + room);
    };
    return at(within(x + times * feature.residual[0], 0),
              within(y + times * feature.residual[1], 1));
  }
  [[nodiscard]] ChartPoint at(double x, double y) const {
    return {corner[0] + pixel * (x - low[0]), corner[1] + pixel * (y - low[1])};
  }
};

/// A round factor that keeps nearly all arrows within a sixteenth of the chart.
/// @param sorted  lengths of the residuals, pixels, ascending
/// @param pixel   length of a pixel in the chart
[[nodiscard]] double arrow_times(const std::vector<double>& sorted, double pixel);

/// Appends an arrow to a path; a very short one has no head.
void append_arrow(std::string& path, ChartPoint from, ChartPoint to);

}  // namespace kinecal::detail
