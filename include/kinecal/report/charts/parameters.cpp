// Drawing parameters.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/report/text.hpp"

namespace kinecal {

namespace detail {
namespace {

constexpr double kInterval = 1.96;  // standard deviations: 95 %

/// A parameter in the displayed unit.
struct ForestRow {
  const ReportedParameter* parameter = nullptr;
  double change = 0.0;  ///< value minus initial value
  double half = 0.0;    ///< of its interval; 0: unknown
  bool determined = true, significant = true;

  /// The end of its interval farther from zero.
  [[nodiscard]] double reach() const { return std::abs(change) + half; }
};

/// Factor and name of a parameter's displayed unit.
[[nodiscard]] std::pair<double, std::string> parameter_unit(const std::string& unit) {
  if (unit == "1") return {100.0, "%"};
  return {people_factor(unit), people_unit(unit)};
}

[[nodiscard]] ForestRow forest_row(const ReportedParameter& parameter) {
  const double factor = parameter_unit(parameter.unit).first;
  ForestRow row{&parameter, factor * (parameter.value - parameter.initial)};
  row.determined = parameter.note != "not determined";
  row.significant = row.determined && parameter.note != "not significant" &&
                    parameter.note != "hardly determined";
  if (parameter.sigma && std::isfinite(*parameter.sigma)) {
    row.half = kInterval * factor * std::abs(*parameter.sigma);
  }
  return row;
}

/// "−1.230 ± 0.050 mm": one standard deviation, with the digits of the table.
[[nodiscard]] std::string forest_figure(const ForestRow& row) {
  if (!row.determined) return "not determined";
  const std::string unit = parameter_unit(row.parameter->unit).second;
  const std::string behind = (unit == "°" ? "" : " ") + unit;
  const bool at_bound = row.parameter->note == "at its bound";
  const bool usual = row.half > 1e-6 && row.half < 1e6;  // others have too many digits
  if (!usual || !(std::abs(row.change) < 1e9)) {
    return figure(row.change) + behind + (at_bound ? " (bound)" : "");
  }
  const ReportedParameter& of = *row.parameter;
  std::string value = for_people(of.value - of.initial, of.unit).first;
  if (value.starts_with('-')) value.replace(0, 1, "\u2212");
  return value + " ± " + for_people(*of.sigma, of.unit).first + behind;
}

/// Symmetric about zero.  A few parameters far beyond all others end at its edge.
[[nodiscard]] Axis forest_axis(const std::vector<ForestRow>& rows, double from, double to) {
  std::vector<double> reaches;
  for (const ForestRow& row : rows) {
    const bool known = row.determined && row.parameter->note != "hardly determined";
    if (known) reaches.push_back(row.reach());
  }
  reaches = sorted_finite(reaches);
  constexpr double kFarther = 8.0;
  const double usual = quantile(reaches, 0.75);
  while (usual > 0.0 && reaches.back() > kFarther * usual) reaches.pop_back();
  const double end = !reaches.empty() && reaches.back() > 0.0 ? 1.06 * reaches.back() : 1.0;
  return Axis::exact(-end, end, from, to);
}

/// An arrow that points beyond the axis.
void draw_beyond(Drawing& drawing, double at, double y, double direction, const char* classes) {
  drawing.path(fmt::format("M{0} {1}L{2} {3}L{0} {4}", coordinate(at - 6.0 * direction),
                           coordinate(y - 4.0), coordinate(at), coordinate(y), coordinate(y + 4.0)),
               classes);
}

void draw_forest_mark(Drawing& drawing, const ForestRow& row, const Axis& x, double y) {
  if (!std::isfinite(row.change)) return;
  const char* line = row.significant ? "after thick" : "faint";
  const double low = row.change - row.half, high = row.change + row.half;
  if (row.half > 0.0) drawing.line({x.at(low), y}, {x.at(high), y}, line);
  if (low < x.low()) draw_beyond(drawing, x.from(), y, -1.0, line);
  if (high > x.high()) draw_beyond(drawing, x.to(), y, 1.0, line);
  if (row.change >= x.low() && row.change <= x.high()) {
    drawing.circle({x.at(row.change), y}, row.significant ? 3.6 : 3.0,
                   row.significant ? "after" : "faint", 0, row.parameter->name);
  }
}

void draw_forest_row(Drawing& drawing, const ForestRow& row, const PlotArea& area, const Axis& x,
                     double y) {
  const ReportedParameter& parameter = *row.parameter;
  drawing.name({area.left - 6.0, y + 4.0}, parameter.name, area.left - 8.0,
               row.significant ? "small" : "small quiet", Anchor::end);
  if (!row.determined) {
    drawing.hatching({area.left, y - 7.0}, area.right - area.left, 14.0,
                     parameter.name + ": not determined by these samples");
  } else {
    draw_forest_mark(drawing, row, x, y);
  }
  const std::string text = forest_figure(row);
  drawing.text({kChartWidth - 2.0, y + 4.0}, text,
               row.significant ? "small figure" : "small figure quiet", Anchor::end,
               parameter.note.empty() ? std::string() : parameter.name + ": " + parameter.note);
}

[[nodiscard]] std::string forest_description(const std::vector<ForestRow>& rows,
                                             const std::string& unit) {
  std::size_t significant = 0, undetermined = 0;
  const ForestRow* largest = &rows.front();
  for (const ForestRow& row : rows) {
    significant += row.significant ? 1 : 0;
    undetermined += row.determined ? 0 : 1;
    if (row.significant && (!largest->significant || row.reach() > largest->reach()))
      largest = &row;
  }
  std::string text =
      fmt::format("{} parameters in {}: {} significant, {} not determined.", rows.size(),
                  unit.empty() ? "no unit" : unit, significant, undetermined);
  if (largest->significant) {
    text += fmt::format(" The largest change: {}, {}.", shortened(largest->parameter->name, 60),
                        forest_figure(*largest));
  }
  return text;
}

[[nodiscard]] Chart forest_chart(const std::vector<ForestRow>& rows, const std::string& unit,
                                 const std::string& change) {
  const std::string shown = parameter_unit(unit).second;
  const std::string slug = shown == "°" ? "deg" : shown == "%" ? "percent" : slug_of(shown);
  Chart chart{"parameters", "parameters" + (slug.empty() ? "" : "-" + slug),
              "Parameters" + (shown.empty() ? "" : ", " + (shown == "°" ? "degrees" : shown)),
              change +
                  "; ±: one standard deviation; bars: 95 % interval. Faint: not significant; "
                  "arrows: beyond the axis.",
              ""};
  constexpr double kRow = 19.0, kGap = 7.0;
  double height = 30.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool other = i > 0 && rows[i].parameter->owner != rows[i - 1].parameter->owner;
    height += kRow + (other ? kGap : 0.0);
  }
  constexpr double kFont = 12.0, kSpace = 14.0;  // of the figures beside the plot
  double widest = 0.0;
  for (const ForestRow& row : rows) widest = std::max(widest, text_width(forest_figure(row)));
  const PlotArea area{158.0, 26.0, kChartWidth - kFont * widest - kSpace, height};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  const Axis x = forest_axis(rows, area.left, area.right);
  drawing.axis_x(area, x, axis_name("change", unit == "1" ? "%" : unit));
  draw_legend(drawing,
              {{Swatch::dot, "after", "significant"}, {Swatch::dot, "faint", "not significant"}},
              2.0);
  drawing.line({x.at(0.0), area.top}, {x.at(0.0), area.bottom}, "zero");
  double y = area.top + 0.5 * kRow + 2.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (i > 0 && rows[i].parameter->owner != rows[i - 1].parameter->owner) {
      drawing.line({2.0, y - 6.0}, {kChartWidth - 2.0, y - 6.0}, "grid");
      y += kGap;
    }
    draw_forest_row(drawing, rows[i], area, x, y);
    y += kRow;
  }
  chart.svg = drawing.str(forest_description(rows, shown));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> parameter_charts(const ReportData& data, const std::string& change) {
  std::vector<std::string> units;
  for (const ReportedParameter& parameter : data.parameters) {
    if (parameter.note == kInCamera) continue;
    if (std::find(units.begin(), units.end(), parameter.unit) == units.end()) {
      units.push_back(parameter.unit);
    }
  }
  std::vector<Chart> charts;
  for (const std::string& unit : units) {
    std::vector<detail::ForestRow> rows;
    for (const ReportedParameter& parameter : data.parameters) {
      if (parameter.note == kInCamera) continue;
      if (parameter.unit == unit) rows.push_back(detail::forest_row(parameter));
    }
    charts.push_back(detail::forest_chart(rows, unit, change));
  }
  return charts;
}

}  // namespace kinecal
