// Legends of charts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/report/svg.hpp"

namespace kinecal::detail {

/// The symbol before a legend's text.
enum class Swatch { square, line, dot, ring, cross };

/// An entry of a legend.
struct LegendEntry {
  Swatch swatch = Swatch::square;
  const char* classes = "";  ///< of the swatch
  std::string text;
};

/// Draws a legend in lines as wide as the chart.
/// @param top  of its first line
/// @returns    the bottom of its last line
double draw_legend(Drawing& drawing, const std::vector<LegendEntry>& entries, double top,
                   double left = 2.0, double right = kChartWidth - 4.0);

}  // namespace kinecal::detail
