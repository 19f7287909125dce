// Arrows in an image: how long they are drawn, and where they end.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// From pixels of the image to the chart, and how much longer arrows are drawn.
struct ImageScale {
  Place corner = {0.0, 0.0};  ///< of the image in the chart
  Place low = {0.0, 0.0};     ///< of the image, pixels
  Place high = {1.0, 1.0};    ///< its other corner
  double pixel = 1.0;         ///< length of a pixel in the chart
  double times = 1.0;         ///< arrows are longer by this

  /// The end of an arrow, which stays in the image but for a few pixels.
  [[nodiscard]] Place end_of(const ReportedFeature& feature) const {
    const auto [x, y] = *feature.pixel;
    const auto within = [&](double v, std::size_t i) {
      const double room = 8.0 / pixel;
      return std::clamp(v, low[i] - room, high[i] + room);
    };
    return at(within(x + times * feature.residual[0], 0),
              within(y + times * feature.residual[1], 1));
  }
  [[nodiscard]] Place at(double x, double y) const {
    return {corner[0] + pixel * (x - low[0]), corner[1] + pixel * (y - low[1])};
  }
};

/// A round factor with which nearly all arrows are at most a sixteenth of the chart.
/// @param sorted  lengths of the residuals, pixels, ascending
/// @param pixel   length of a pixel in the chart
[[nodiscard]] double arrow_times(const std::vector<double>& sorted, double pixel);

/// Appends an arrow to a path; one that is too short for a head has none.
void append_arrow(std::string& path, Place from, Place to);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/arrows.ipp"
#endif
