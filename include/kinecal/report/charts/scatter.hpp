// Points over an axis with their running median; maps with the same scale on both axes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// A point of a chart, and the number of its sample.
struct ScatterPoint {
  double x = 0.0, y = 0.0;
  int sample = 0;
};

/// Medians of x and y in equal groups of neighbours along x; empty for less than ten points.
[[nodiscard]] std::vector<ChartPoint> running_median(std::vector<ScatterPoint> points);

/// Zero is in the middle.  Values beyond 2.5 times the 95 % quantile are drawn at the edge.
[[nodiscard]] Axis signed_axis(const std::vector<ScatterPoint>& points, double bottom, double top);

/// Dots, thinned, and the running median of all.
/// @returns  the number of dots drawn
std::size_t draw_scatter(Drawing& drawing, const std::vector<ScatterPoint>& points, const Axis& x,
                         const Axis& y);

/// The axes of a map.
struct MapAxes {
  Axis x, y;
  PlotArea area;
};

/// Axes of equal scale that include these limits.
/// @param low, high  (2) limits
/// @param top        of the map in the chart
[[nodiscard]] MapAxes map_axes(std::array<double, 2> low, std::array<double, 2> high, double top,
                               double most_height);

}  // namespace kinecal::detail
