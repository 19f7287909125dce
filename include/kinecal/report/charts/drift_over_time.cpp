// Drawing recordings over weeks.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/drift_over_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

Chart drift_chart(const DriftSeries& series) {
  constexpr double kWeek = 7.0 * 86'400.0;
  Chart chart{"watch", series.name, series.title, series.caption, ""};
  if (series.points.empty()) return chart;
  const double factor = detail::people_factor(series.unit), first = series.points.front().time;
  const auto weeks = [&](double time) { return (time - first) / kWeek; };
  const double end = std::max(weeks(series.points.back().time), 1e-3);
  double low = factor * series.expected, high = low;
  for (const DriftPoint& point : series.points) {
    low = std::min(low, factor * (point.value - point.deviation));
    high = std::max(high, factor * (point.value + point.deviation));
  }
  std::vector<detail::LegendEntry> entries = {{detail::Swatch::dot, "after", "the result holds"},
                                              {detail::Swatch::dot, "bad", "it does not"}};
  if (series.line) entries.push_back({detail::Swatch::line, "after thick", "drift"});
  detail::Drawing measured("", "", 0.0);  // to measure the height of the legend
  const double top = detail::draw_legend(measured, entries, 0.0) + 26.0;
  const detail::PlotArea area{52.0, top, detail::kChartWidth - 12.0, top + 180.0};
  detail::Drawing drawing(chart.name, chart.title, area.bottom + 40.0);
  detail::draw_legend(drawing, entries, 0.0);
  const detail::Axis x = detail::Axis::exact(0.0, end, area.left, area.right);
  const detail::Axis y = detail::Axis::linear(low, high, area.bottom, area.top);
  drawing.axis_y(area, y, detail::axis_name(series.what, series.unit));
  drawing.axis_x(area, x, "weeks");
  const double level = y.at(factor * series.expected);
  drawing.line({area.left, level}, {area.right, level}, "faint");
  std::vector<double> sizes;
  for (const DriftPoint& point : series.points) sizes.push_back(std::abs(point.value));
  for (const std::size_t i : detail::chosen_marks(sizes)) {
    const DriftPoint& point = series.points[i];
    const double at = x.at(weeks(point.time));
    const char* classes = point.holds ? "after" : "bad";
    if (point.deviation > 0.0) {
      drawing.line({at, y.at(factor * (point.value - point.deviation))},
                   {at, y.at(factor * (point.value + point.deviation))}, "faint");
    }
    drawing.circle({at, y.at(factor * point.value)}, 2.4, classes, 0,
                   fmt::format("week {:.1f}: {}", weeks(point.time),
                               detail::with_unit(point.value, series.unit)));
  }
  if (series.line) {
    const auto place = [&](double week) {
      const double time = first + week * kWeek;
      const double value = series.line->level + series.line->slope * (time - series.line->origin);
      return detail::ChartPoint{x.at(week), y.at(factor * value)};
    };
    drawing.line(place(0.0), place(end), "after thick");
  }
  std::string description =
      fmt::format("{} recordings in {:.1f} weeks; the last: {}.", series.points.size(), end,
                  detail::with_unit(series.points.back().value, series.unit));
  if (series.line) {
    description += fmt::format(" Drift: {} a week.",
                               detail::with_unit(kWeek * series.line->slope, series.unit));
  }
  chart.svg = drawing.str(description);
  return chart;
}

}  // namespace kinecal
