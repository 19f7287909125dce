// Drawing errors over the floor.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/planes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/charts/scatter.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// The place of a feature on the floor, metres, and its error in the displayed unit.
struct FloorPoint {
  std::array<double, 2> place{};
  double error = 0.0;
  int sample = 0;
};

[[nodiscard]] std::vector<FloorPoint> floor_points(const ReportData& data,
                                                   const ReportedBlock& block) {
  std::vector<FloorPoint> points;
  if (!block.is_plane) return points;
  for (const ReportedFeature& feature : block.features) {
    if (!feature.point || sample_of(data, feature).left_out) continue;
    const bool is_signed = block.components == 1 && !feature.residual.empty();
    const double error = is_signed ? feature.residual[0] : feature.after;
    const auto [x, y, z] = *feature.point;
    constexpr double kFarthest = 1e4;  // metres
    if (!(std::abs(x) < kFarthest && std::abs(y) < kFarthest) || !std::isfinite(error)) continue;
    points.push_back({{x, y}, people_factor(block.unit) * error, sample_number(data, feature)});
  }
  return points;
}

/// CSS class of an error; `most` and larger errors have the strongest colour.
[[nodiscard]] std::string error_class(double error, double most) {
  const double share = std::abs(error) / most;
  if (share < 0.1) return "none";
  const char* level = share >= 0.9 ? "" : share >= 0.6 ? " l4" : share >= 0.3 ? " l3" : " l2";
  return (error < 0.0 ? "minus" : "plus") + std::string(level);
}

[[nodiscard]] std::vector<LegendEntry> error_legend(double most, const std::string& unit) {
  const std::string end = figure(most), half = figure(0.5 * most);
  return {{Swatch::dot, "minus", "−" + end + " and less"},
          {Swatch::dot, "minus l3", "−" + half},
          {Swatch::dot, "none", "0"},
          {Swatch::dot, "plus l3", half},
          {Swatch::dot, "plus", end + " " + unit + " and more"}};
}

[[nodiscard]] Chart plane_chart(const ReportedBlock& block, const std::string& slug,
                                const std::vector<FloorPoint>& points) {
  constexpr std::size_t kMostPoints = 1000;
  std::array<double, 2> low = points[0].place, high = points[0].place;
  std::vector<double> sizes;
  for (const FloorPoint& point : points) {
    sizes.push_back(std::abs(point.error));
    for (std::size_t i = 0; i < 2; ++i) {
      low[i] = std::min(low[i], point.place[i]);
      high[i] = std::max(high[i], point.place[i]);
    }
  }
  const auto chosen = chosen_marks(sizes, kMostPoints);
  const std::vector<double> sorted = sorted_finite(sizes);
  const double usual = quantile(sorted, 0.95);
  const double most = usual > 0.0 ? round_step(usual, 1) : 1.0;
  Chart chart{"planes", "planes-" + slug, "Error over the plane: " + shortened(block.name, 60),
              "Seen from above, in the base. Regions of one colour are an error that the "
              "calibration has not removed." +
                  chosen_text(chosen.size(), points.size(), "points"),
              ""};
  const MapAxes map = map_axes(low, high, 46.0, 360.0);
  Drawing drawing(chart.name, chart.title, map.area.bottom + 38.0);
  const std::string unit = people_unit(block.unit);
  draw_legend(drawing, error_legend(most, unit), 0.0);
  drawing.axes(map.area, map.x, map.y, "x, m", "y, m");
  for (const std::size_t i : chosen) {
    const FloorPoint& point = points[i];
    drawing.circle({map.x.at(point.place[0]), map.y.at(point.place[1])}, 4.0,
                   error_class(point.error, most).c_str(), point.sample);
  }
  chart.svg = drawing.str(fmt::format(
      "Errors of {} points over the plane. Median size {} {}, 95 % below {} {}.",
      count_text(points.size()), figure(quantile(sorted, 0.5)), unit, figure(usual), unit));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> plane_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    const auto points = detail::floor_points(data, block);
    return points.empty() ? Chart() : detail::plane_chart(block, slug, points);
  });
}

}  // namespace kinecal
