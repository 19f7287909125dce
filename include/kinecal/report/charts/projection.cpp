// Drawing how well cameras are known.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/projection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Upper ends of the colours, pixels; the last one is open.
constexpr std::array kEnds = {0.05, 0.1, 0.25, 0.5};
constexpr int kColors = static_cast<int>(kEnds.size()) + 1;

[[nodiscard]] int color_of(double pixels) {
  return static_cast<int>(std::lower_bound(kEnds.begin(), kEnds.end(), pixels) - kEnds.begin());
}

void draw_pixel_colors(Drawing& drawing) {
  constexpr double kLeft = 46.0, kWidth = 66.0, kTop = 20.0, kHigh = 12.0;
  drawing.text({2.0, 12.0}, "pixels", "name");
  for (int i = 0; i < kColors; ++i) {
    drawing.rectangle({kLeft + kWidth * i, kTop}, kWidth, kHigh,
                      fmt::format("scale{}", i + 1).c_str());
    if (i + 1 == kColors) break;
    drawing.text({kLeft + kWidth * (i + 1), kTop + kHigh + 14.0},
                 figure(kEnds[static_cast<std::size_t>(i)]), "small figure", Anchor::middle);
  }
}

/// One map; cells without features have a dot.
/// @returns  its lower end
double draw_map(Drawing& drawing, const ProjectionMap& map, double top, const char* name,
                double (*size)(const KnownPixel&)) {
  constexpr double kMargin = 12.0, kMostHeight = 300.0;
  const double width = map.high[0] - map.low[0], height = map.high[1] - map.low[1];
  const double scale = std::min((kChartWidth - 2.0 * kMargin) / width, kMostHeight / height);
  const ChartPoint corner = {0.5 * (kChartWidth - scale * width), top + 8.0};
  const double wide = scale * width / map.columns, high = scale * height / map.rows;
  drawing.text({corner[0], top}, name, "name");
  std::string dots;
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    const KnownPixel& cell = map.cells[i];
    const double pixels = size(cell);
    const auto column = static_cast<int>(i) % map.columns, row = static_cast<int>(i) / map.columns;
    const ChartPoint at = {corner[0] + wide * column, corner[1] + high * row};
    if (std::isnan(pixels)) continue;
    drawing.rectangle(
        at, wide, high, fmt::format("scale{}", color_of(pixels) + 1).c_str(),
        std::isfinite(pixels) ? fmt::format("{} px", figure(pixels)) : "not determined");
    if (cell.features == 0) append_dot(dots, {at[0] + 0.5 * wide, at[1] + 0.5 * high});
  }
  if (!dots.empty()) drawing.path(dots, "halo");
  drawing.rectangle(corner, scale * width, scale * height, "frame");
  return corner[1] + scale * height;
}

[[nodiscard]] Chart projection_chart(const ProjectionMap& map) {
  Chart chart{
      "pixels", "projection-" + map.sensor,
      "How well camera '" + map.sensor + "' is known over its image",
      "One standard deviation of the pixel of a point, relative to what the camera saw. Dots: "
      "no feature was there; hold the target there.",
      ""};
  if (map.halves) {
    chart.caption += fmt::format(
        " Below, how far two halves of the samples put a pixel apart: {} px over the cells with "
        "features, and the ± allow {} px.",
        figure(map.halves->difference), figure(map.halves->allowed));
  }
  const double width = map.high[0] - map.low[0], height = map.high[1] - map.low[1];
  const double each = std::min(300.0, (kChartWidth - 24.0) * height / width) + 40.0;
  Drawing drawing(chart.name, chart.title, 60.0 + each * (map.halves ? 2.0 : 1.0));
  draw_pixel_colors(drawing);
  const double bottom = draw_map(drawing, map, 72.0, "standard deviation",
                                 [](const KnownPixel& cell) { return cell.deviation(); });
  if (map.halves) {
    (void)draw_map(drawing, map, bottom + 26.0, "difference between two halves of the samples",
                   [](const KnownPixel& cell) { return cell.difference; });
  }
  const auto [least, median, most] = map.deviations();
  chart.svg = drawing.str(fmt::format(
      "Standard deviation of a pixel: {} px at best, {} px where features are, {} px at worst.",
      figure(least), figure(median), figure(most)));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> projection_charts(const ReportData& data) {
  std::vector<Chart> charts;
  for (const ProjectionMap& map : data.cameras) charts.push_back(detail::projection_chart(map));
  return charts;
}

}  // namespace kinecal
