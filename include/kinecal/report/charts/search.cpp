// Drawing a search.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// "18 parameters: 0.112 ± 0.009 mm"
[[nodiscard]] std::string held_out_text(const ReportedSearchStep& step, const std::string& unit) {
  const double factor = people_factor(unit);
  return fmt::format("{} parameter{}: {} ± {}{}{}", step.parameters,
                     step.parameters == 1 ? "" : "s", figure(factor * step.held_out),
                     figure(factor * step.deviation, 2), people_unit(unit).empty() ? "" : " ",
                     people_unit(unit));
}

/// Of errors with their bars; logarithmic if the first is many times the last.
[[nodiscard]] Axis error_axis(const ReportedSearch& search, const PlotArea& area) {
  const double factor = people_factor(search.unit);
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const ReportedSearchStep& step : search.steps) {
    if (std::isfinite(step.fitted) && step.fitted > 0.0) low = std::min(low, factor * step.fitted);
    if (!std::isfinite(step.held_out)) continue;
    const double below = factor * (step.held_out - step.deviation);
    if (below > 0.0) low = std::min(low, below);
    high = std::max(high, factor * (step.held_out + step.deviation));
  }
  constexpr double kManyTimes = 3.0;
  if (high > kManyTimes * low) {
    return Axis::logarithmic(0.8 * low, 1.25 * high, area.bottom, area.top);
  }
  return Axis::linear(0.0, high, area.bottom, area.top);
}

/// The bar of one standard error on both sides, with ends.
void draw_bar(Drawing& drawing, const ReportedSearchStep& step, double factor, double x,
              const Axis& y) {
  constexpr double kEnd = 4.0;
  const double top = y.at(factor * (step.held_out + step.deviation)),
               bottom = y.at(factor * (step.held_out - step.deviation));
  const char* classes = step.is_chosen ? "median" : "faint";
  drawing.line({x, top}, {x, bottom}, classes);
  drawing.line({x - kEnd, top}, {x + kEnd, top}, classes);
  drawing.line({x - kEnd, bottom}, {x + kEnd, bottom}, classes);
}

[[nodiscard]] std::string draw_search(const Chart& chart, const ReportedSearch& search) {
  const PlotArea area{52.0, 24.0, kChartWidth - 12.0, 250.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 82.0);
  const double factor = people_factor(search.unit);
  int fewest = std::numeric_limits<int>::max(), most = 0;
  for (const ReportedSearchStep& step : search.steps) {
    fewest = std::min(fewest, step.parameters);
    most = std::max(most, step.parameters);
  }
  const Axis x = Axis::exact(fewest - 0.7, most + 0.7, area.left, area.right);
  const Axis y = error_axis(search, area);
  drawing.axis_x(area, x, "free parameters", true);
  drawing.axis_y(area, y,
                 search.unit == "1" ? "error, times the noise" : axis_name("error", search.unit));
  std::vector<ChartPoint> fitted, held_out;
  const ReportedSearchStep* chosen = nullptr;
  for (const ReportedSearchStep& step : search.steps) {
    const double at = x.at(step.parameters);
    fitted.push_back({at, y.at(factor * step.fitted)});
    if (!std::isfinite(step.held_out)) continue;
    held_out.push_back({at, y.at(factor * step.held_out)});
    if (step.is_chosen) chosen = &step;
  }
  drawing.curve(fitted, "after thick");
  drawing.curve(held_out, "faint");
  for (const ReportedSearchStep& step : search.steps) {
    if (!std::isfinite(step.held_out)) continue;
    const double at = x.at(step.parameters);
    draw_bar(drawing, step, factor, at, y);
    drawing.circle(
        {at, y.at(factor * step.held_out)}, 3.0, step.is_chosen ? "held" : "faint", 0,
        (step.freed.empty() ? "" : step.freed + "; ") + held_out_text(step, search.unit));
  }
  std::string description = "Error on held-out poses over the number of free parameters.";
  std::vector<LegendEntry> legend = {{Swatch::dot, "held", "held out ± standard error"},
                                     {Swatch::line, "after thick", "fitted"}};
  if (!search.steps.back().is_chosen) {
    legend.push_back({Swatch::dot, "faint", "held out, not freed"});
  }
  if (chosen != nullptr) {
    const ChartPoint place{x.at(chosen->parameters), y.at(factor * chosen->held_out)};
    drawing.line({place[0], area.top}, {place[0], place[1] - 9.0}, "zero");
    drawing.circle(place, 9.0, "ring after");
    const bool is_right = place[0] > 0.5 * (area.left + area.right);
    drawing.text({place[0] + (is_right ? -6.0 : 6.0), area.top + 12.0},
                 "chosen, " + held_out_text(*chosen, search.unit), "small strong halo",
                 is_right ? Anchor::end : Anchor::start);
    legend.push_back({Swatch::ring, "ring after", "chosen"});
    description += " Before: " + held_out_text(search.steps.front(), search.unit) +
                   ". Chosen: " + held_out_text(*chosen, search.unit) + ".";
  }
  draw_legend(drawing, legend, area.bottom + 42.0);
  return drawing.str(description);
}

}  // namespace
}  // namespace detail

std::vector<Chart> search_charts(const ReportData& data) {
  if (data.search.steps.empty()) return {};
  Chart chart{
      "search", "search", "What each parameter bought",
      "The bars are one standard error. A parameter is freed if the error on held-out poses "
      "falls by more than chance; those tried after the chosen ones do not lower it so much.",
      ""};
  chart.svg = detail::draw_search(chart, data.search);
  return {chart};
}

}  // namespace kinecal
