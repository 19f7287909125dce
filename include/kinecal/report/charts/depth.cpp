// Drawing errors over depth.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/depth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/charts/distance_axis.hpp"
#include "kinecal/report/charts/scatter.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Depth in metres and error in the unit for people, of features that have both.
[[nodiscard]] std::vector<ScatterPoint> depth_points(const ReportData& data,
                                                     const ReportedBlock& block, bool is_signed) {
  std::vector<ScatterPoint> points;
  for (const ReportedFeature& feature : block.features) {
    if (!feature.depth || !std::isfinite(*feature.depth)) continue;
    if (sample_of(data, feature).left_out) continue;
    const double error = is_signed ? feature.residual[0] : std::abs(feature.after);
    if (!std::isfinite(error)) continue;
    points.push_back(
        {*feature.depth, people_factor(block.unit) * error, sample_number(data, feature)});
  }
  return points;
}

[[nodiscard]] std::string depth_description(const std::vector<ScatterPoint>& points,
                                            const std::string& unit) {
  const auto [near, far] =
      std::minmax_element(points.begin(), points.end(),
                          [](const ScatterPoint& a, const ScatterPoint& b) { return a.x < b.x; });
  std::string text = fmt::format("Errors of {} features at depths from {} to {} m.",
                                 count_text(points.size()), figure(near->x), figure(far->x));
  const std::vector<ChartPoint> medians = running_median(points);
  if (!medians.empty()) {
    text += fmt::format(" The median is {} near and {} {} far.", figure(medians.front()[1]),
                        figure(medians.back()[1]), people_unit(unit));
  }
  return text;
}

[[nodiscard]] Chart depth_chart(const ReportData& data, const ReportedBlock& block,
                                const std::string& slug) {
  const bool is_signed = block.components == 1 &&
                         std::all_of(block.features.begin(), block.features.end(),
                                     [](const ReportedFeature& f) { return !f.residual.empty(); });
  const std::vector<ScatterPoint> points = depth_points(data, block, is_signed);
  Chart chart{"depth", "depth-" + slug, "Error against depth: " + shortened(block.name, 60),
              "An error that grows with the depth points to the camera's depth scale, or to its "
              "orientation.",
              ""};
  if (points.empty()) return chart;
  const PlotArea area{46.0, 46.0, kChartWidth - 12.0, 250.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  std::vector<double> depths, errors;
  for (const ScatterPoint& point : points) {
    depths.push_back(point.x);
    errors.push_back(point.y);
  }
  const auto [low, high] = std::minmax_element(depths.begin(), depths.end());
  const Axis x = Axis::linear(*low, *high, area.left, area.right);
  const Axis y = is_signed ? signed_axis(points, area.bottom, area.top)
                           : distance_axis(block, sorted_finite(errors), area.bottom, area.top);
  drawing.axes(area, x, y, "depth, m", axis_name(is_signed ? "error" : "distance", block.unit));
  if (is_signed) drawing.line({area.left, y.at(0.0)}, {area.right, y.at(0.0)}, "zero");
  chart.caption += chosen_text(draw_scatter(drawing, points, x, y), points.size(), "features");
  draw_legend(drawing,
              {{Swatch::dot, "after", "feature"}, {Swatch::line, "median", "running median"}}, 0.0);
  chart.svg = drawing.str(depth_description(points, block.unit));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> depth_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    return detail::depth_chart(data, block, slug);
  });
}

}  // namespace kinecal
