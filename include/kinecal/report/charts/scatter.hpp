// Points over an axis with their running median, and maps of which both axes have one scale.
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

/// Medians of x and y in groups of equally many neighbours along x; none of less than ten points.
[[nodiscard]] std::vector<Place> running_median(std::vector<ScatterPoint> points);

/// Zero is in the middle.  Values beyond two and a half times what 95 % are below are drawn at the edge.
[[nodiscard]] Axis signed_axis(const std::vector<ScatterPoint>& points, double bottom, double top);

/// Dots, thinned, and the running median of all.
/// @returns  how many are drawn
std::size_t draw_scatter(Drawing& drawing, const std::vector<ScatterPoint>& points, const Axis& x,
                         const Axis& y);

/// The axes of a map.
struct MapAxes {
  Axis x, y;
  PlotArea area;
};

/// Axes of one scale for what lies within these limits.
/// @param low, high  (2) limits
/// @param top        of the map in the chart
[[nodiscard]] MapAxes map_axes(std::array<double, 2> low, std::array<double, 2> high, double top,
                               double most_height);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/charts/scatter.ipp"
#endif
