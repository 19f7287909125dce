// Drawing radial profiles.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/radial.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/charts/image_place.hpp"
#include "kinecal/report/charts/scatter.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Parts of residuals over the radius, pixels.
struct RadialPoints {
  std::vector<ScatterPoint> outwards, across;
};

[[nodiscard]] RadialPoints radial_points(const ReportData& data,
                                         const std::vector<const ReportedFeature*>& features,
                                         const ImageFrame& frame) {
  const ChartPoint middle = {0.5 * (frame.low[0] + frame.high[0]),
                             0.5 * (frame.low[1] + frame.high[1])};
  RadialPoints points;
  for (const ReportedFeature* feature : features) {
    const double x = (*feature->pixel)[0] - middle[0], y = (*feature->pixel)[1] - middle[1];
    const double radius = std::hypot(x, y);
    if (!(radius > 0.0)) continue;
    const double u = feature->residual[0], v = feature->residual[1];
    const int sample = sample_number(data, *feature);
    points.outwards.push_back({radius, (u * x + v * y) / radius, sample});
    points.across.push_back({radius, (v * x - u * y) / radius, sample});
  }
  return points;
}

/// One of the two parts.
/// @returns  the number of dots drawn
std::size_t draw_part(Drawing& drawing, const std::vector<ScatterPoint>& points, double top,
                      double bottom, const char* name, bool names_x) {
  const PlotArea area{46.0, top, kChartWidth - 12.0, bottom};
  double farthest = 0.0;
  for (const ScatterPoint& point : points) farthest = std::max(farthest, point.x);
  const Axis x = Axis::linear(0.0, farthest, area.left, area.right);
  const Axis y = signed_axis(points, area.bottom, area.top);
  drawing.axes(area, x, y, names_x ? "distance from the middle, px" : "", name);
  drawing.line({area.left, y.at(0.0)}, {area.right, y.at(0.0)}, "zero");
  return draw_scatter(drawing, points, x, y);
}

[[nodiscard]] Chart radial_chart(const RadialPoints& points, const ReportedBlock& block,
                                 const std::string& slug) {
  Chart chart{
      "pixels", "radial-" + slug, "Radial profile: " + shortened(block.name, 60),
      "A radial median that leaves zero towards the rim is a lens error that the model does "
      "not have.",
      ""};
  Drawing drawing(chart.name, chart.title, 384.0);
  draw_legend(drawing,
              {{Swatch::dot, "after", "feature"}, {Swatch::line, "median", "running median"}}, 0.0);
  const std::size_t shown = draw_part(drawing, points.outwards, 44.0, 170.0, "outwards, px", false);
  draw_part(drawing, points.across, 220.0, 346.0, "across, px", true);
  chart.caption += chosen_text(shown, points.outwards.size(), "features");
  std::string description = "Parts of residuals over the distance from the middle of the image.";
  const std::vector<ChartPoint> medians = running_median(points.outwards);
  if (!medians.empty()) {
    description += fmt::format(" The radial median is {} px near the middle and {} px at the rim.",
                               figure(medians.front()[1], 2), figure(medians.back()[1], 2));
  }
  chart.svg = drawing.str(description);
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> radial_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    const auto features = detail::features_in_image(data, block);
    const auto frame = detail::image_frame(block, features);
    const auto points = detail::radial_points(data, features, frame);
    return points.outwards.empty() ? Chart() : detail::radial_chart(points, block, slug);
  });
}

}  // namespace kinecal
