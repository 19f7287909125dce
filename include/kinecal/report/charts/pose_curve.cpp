// Drawing accuracy by number of poses.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/pose_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// "1 pose", "14 poses".
[[nodiscard]] std::string poses_text(int poses) {
  return fmt::format("{} pose{}", poses, poses == 1 ? "" : "s");
}

/// "14 poses: 0.497 mm"
[[nodiscard]] std::string accuracy_text(const PoseAccuracy& point) {
  return poses_text(point.poses) + ": " + with_unit(point.position, "m");
}

/// Positions in millimetres, from less than the best one; limited to a multiple of it.
[[nodiscard]] Axis accuracy_axis(const PoseCurve& curve, double bottom, double top) {
  constexpr double kSpan = 300.0, kNear = 10.0;
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const auto* points : {&curve.selected, &curve.random}) {
    for (const PoseAccuracy& point : *points) {
      if (!std::isfinite(point.position) || !(point.position > 0.0)) continue;
      low = std::min(low, 1e3 * point.position);
      high = std::max(high, 1e3 * point.position);
    }
  }
  high = std::min(high, kSpan * low);
  const double wanted = 1e3 * curve.wanted;
  if (wanted > low / kNear && wanted < high * kNear) {
    low = std::min(low, wanted);
    high = std::max(high, wanted);
  }
  return Axis::logarithmic(0.85 * low, 1.2 * high, bottom, top);
}

/// A line with dots; values beyond the axis interrupt it.
void draw_accuracies(Drawing& drawing, const std::vector<PoseAccuracy>& points, const Axis& x,
                     const Axis& y, const char* line, const char* dots) {
  std::vector<ChartPoint> places;
  for (const PoseAccuracy& point : points) {
    const double shown = 1e3 * point.position;
    const bool inside = shown >= y.low() && shown <= y.high();
    places.push_back(
        {x.at(point.poses), inside ? y.at(shown) : std::numeric_limits<double>::quiet_NaN()});
  }
  drawing.curve(places, line);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(places[i][1])) continue;
    drawing.circle(places[i], 2.4, dots, 0, accuracy_text(points[i]));
  }
}

/// The knee as a vertical line, labelled at its top, clear of the falling curve.
void draw_knee(Drawing& drawing, int knee, const PlotArea& area, const Axis& x) {
  const double at = x.at(knee);
  const bool is_far = at > 0.5 * (area.left + area.right);
  drawing.line({at, area.top}, {at, area.bottom}, "faint");
  drawing.text({at + (is_far ? -6.0 : 6.0), area.top + 15.0}, "knee: " + poses_text(knee),
               "small strong", is_far ? Anchor::end : Anchor::start);
}

[[nodiscard]] std::vector<LegendEntry> pose_curve_legend(const PoseCurve& curve) {
  std::vector<LegendEntry> entries = {{Swatch::line, "after thick", "selected poses"}};
  if (!curve.random.empty()) entries.push_back({Swatch::line, "before", "random sets, median"});
  entries.push_back({Swatch::line, "sigma", "asked for: " + with_unit(curve.wanted, "m")});
  if (curve.enough && curve.enough->poses > 0)
    entries.push_back({Swatch::dot, "good", accuracy_text(*curve.enough)});
  if (curve.have > 0 && !curve.selected.empty()) {
    entries.push_back({Swatch::ring, "ring after",
                       "your " + accuracy_text({curve.have, curve.selected.front().position})});
  }
  return entries;
}

[[nodiscard]] std::string pose_curve_description(const PoseCurve& curve) {
  std::string text = "Expected standard deviation of the position.";
  const auto first =
      std::find_if(curve.selected.begin(), curve.selected.end(),
                   [](const PoseAccuracy& point) { return std::isfinite(point.position); });
  if (first == curve.selected.end()) return text + " It is not determined.";
  text += fmt::format(" Selected: {}; {}.", accuracy_text(*first),
                      accuracy_text(curve.selected.back()));
  if (!curve.random.empty()) {
    text += fmt::format(" Random: {}.", accuracy_text(curve.random.back()));
  }
  text += fmt::format(" Asked for: {}", with_unit(curve.wanted, "m"));
  text += curve.enough ? fmt::format(", {}.", accuracy_text(*curve.enough)) : ", not reached.";
  if (curve.knee) text += fmt::format(" Knee: {}.", poses_text(*curve.knee));
  return text;
}

/// What is drawn between the axes.
void draw_pose_curve(Drawing& drawing, const PoseCurve& curve, const PlotArea& area) {
  double most = 1.0;
  for (const PoseAccuracy& point : curve.selected) most = std::max(most, double(point.poses));
  const Axis x = Axis::exact(0.0, most, area.left, area.right);
  const Axis y = accuracy_axis(curve, area.bottom, area.top);
  drawing.axis_y(area, y, "standard deviation of the position, mm");
  drawing.axis_x(area, x, curve.have > 0 ? "more poses" : "poses", true);
  if (curve.knee) draw_knee(drawing, *curve.knee, area, x);
  const double wanted = 1e3 * curve.wanted;
  if (wanted >= y.low() && wanted <= y.high()) {
    drawing.line({area.left, y.at(wanted)}, {area.right, y.at(wanted)}, "sigma");
  }
  draw_accuracies(drawing, curve.random, x, y, "before", "before");
  draw_accuracies(drawing, curve.selected, x, y, "after thick", "after");
  const auto mark = [&](const PoseAccuracy& point, double radius, const char* classes) {
    if (!std::isfinite(point.position)) return;
    drawing.circle({x.at(point.poses), y.at(1e3 * point.position)}, radius, classes, 0,
                   accuracy_text(point));
  };
  for (const PoseAccuracy& point : curve.selected) {
    if (curve.knee && point.poses == *curve.knee) mark(point, 4.5, "after");
  }
  if (curve.have > 0 && !curve.selected.empty()) mark(curve.selected.front(), 6.0, "ring after");
  if (curve.enough && curve.enough->poses > 0) mark(*curve.enough, 5.0, "good");
}

}  // namespace
}  // namespace detail

Chart pose_curve_chart(const PoseCurve& curve) {
  Chart chart{"poses", "pose-curve", "Accuracy and number of poses",
              "One standard deviation, as the covariance expects it, before anything is measured.",
              ""};
  if (curve.knee) {
    chart.caption += " After the knee, five more poses improve it by less than 5 %.";
  } else if (!curve.selected.empty()) {
    chart.caption += " No knee within " + detail::poses_text(curve.selected.back().poses) + ".";
  }
  if (curve.remaining > 0.0) {
    chart.caption += " It is the spread only: without noise calibrations are " +
                     detail::with_unit(curve.remaining, "m") + " off.";
  }
  if (!curve.enough) chart.caption += " What is asked for is not reached.";
  const std::vector<detail::LegendEntry> entries = detail::pose_curve_legend(curve);
  detail::Drawing measured("", "", 0.0);  // to measure the height of the legend
  const double top = detail::draw_legend(measured, entries, 0.0) + 26.0;
  const detail::PlotArea area{48.0, top, detail::kChartWidth - 12.0, top + 224.0};
  detail::Drawing drawing(chart.name, chart.title, area.bottom + 40.0);
  detail::draw_legend(drawing, entries, 0.0);
  detail::draw_pose_curve(drawing, curve, area);
  chart.svg = drawing.str(detail::pose_curve_description(curve));
  return chart;
}

}  // namespace kinecal
