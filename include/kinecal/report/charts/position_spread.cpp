// Drawing how the position varies.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/position_spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A line with dots; values that are not finite interrupt it.
void draw_spreads(Drawing& drawing, const std::vector<PositionSpread>& points,
                  double PositionSpread::*value, const Axis& x, const Axis& y, const char* line,
                  const char* dots) {
  std::vector<ChartPoint> places;
  for (const PositionSpread& point : points) {
    const double shown = 1e3 * point.*value;
    places.push_back({x.at(point.poses), std::isfinite(shown)
                                             ? y.at(shown)
                                             : std::numeric_limits<double>::quiet_NaN()});
  }
  drawing.curve(places, line);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(places[i][1])) continue;
    drawing.circle(places[i], 4.0, dots, 0,
                   fmt::format("{} poses: {}", points[i].poses, with_unit(points[i].*value, "m")));
  }
}

/// Ticks at the numbers of poses; one too close to the previous one has no label.
void draw_pose_ticks(Drawing& drawing, const std::vector<PositionSpread>& points,
                     const PlotArea& area, const Axis& x) {
  constexpr double kApart = 28.0;
  double before = -kApart;
  for (const PositionSpread& point : points) {
    const double at = x.at(point.poses);
    drawing.line({at, area.top}, {at, area.bottom}, "grid");
    if (at - before < kApart) continue;
    drawing.text({at, area.bottom + 16.0}, std::to_string(point.poses), "tick", Anchor::middle);
    before = at;
  }
  drawing.line({area.left, area.bottom}, {area.right, area.bottom}, "axis");
  drawing.text({area.right, area.bottom + 33.0}, "poses of a calibration", "name", Anchor::end);
}

}  // namespace
}  // namespace detail

Chart position_spread_chart(const std::vector<PositionSpread>& points) {
  Chart chart{"repeatability", "position-spread", "Position and number of poses",
              "How far off the position is (RMS), how much it varies between calibrations of the "
              "same robot, and how much the covariance predicts (one standard deviation).",
              ""};
  const detail::PlotArea area{48.0, 44.0, detail::kChartWidth - 16.0, 254.0};
  detail::Drawing drawing(chart.name, chart.title, area.bottom + 40.0);
  detail::draw_legend(drawing,
                      {{detail::Swatch::dot, "bad", "error, RMS"},
                       {detail::Swatch::dot, "after", "varied"},
                       {detail::Swatch::ring, "ring before", "predicted by the covariance"}},
                      0.0);
  double highest = 0.0, most = 1.0;
  std::string description = "Error and standard deviation of the position.";
  for (const PositionSpread& point : points) {
    for (const double value : {point.off, point.varied, point.predicted}) {
      if (std::isfinite(value)) highest = std::max(highest, 1e3 * value);
    }
    most = std::max(most, static_cast<double>(point.poses));
    description +=
        fmt::format(" {} poses: off {}, varied {}, predicted {}.", point.poses,
                    detail::with_unit(point.off, "m"), detail::with_unit(point.varied, "m"),
                    detail::with_unit(point.predicted, "m"));
  }
  const detail::Axis x = detail::Axis::exact(0.0, 1.04 * most, area.left, area.right);
  const detail::Axis y = detail::Axis::linear(0.0, highest, area.bottom, area.top);
  drawing.axis_y(area, y, "position, mm");
  detail::draw_pose_ticks(drawing, points, area, x);
  detail::draw_spreads(drawing, points, &PositionSpread::predicted, x, y, "before", "ring before");
  detail::draw_spreads(drawing, points, &PositionSpread::off, x, y, "bad", "bad");
  detail::draw_spreads(drawing, points, &PositionSpread::varied, x, y, "after thick", "after");
  chart.svg = drawing.str(description);
  return chart;
}

}  // namespace kinecal
