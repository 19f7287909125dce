// Drawing convergence and minima.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/convergence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] Axis cost_axis(const std::vector<StepResult>& steps, double bottom, double top) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const StepResult& step : steps) {
    for (const double cost : step.costs) {
      if (!(cost > 0.0) || !std::isfinite(cost)) continue;
      low = std::min(low, cost);
      high = std::max(high, cost);
    }
  }
  return Axis::logarithmic(0.7 * low, 1.4 * high, bottom, top);
}

/// A curve for each run of a step; a rising cost starts another run.
/// @param first  number of the step's first iteration on the axis
void draw_runs(Drawing& drawing, const StepResult& step, double first, const Axis& x,
               const Axis& y) {
  std::vector<ChartPoint> places;
  std::string dots;
  double before = std::numeric_limits<double>::infinity();
  const std::size_t every = 1 + step.costs.size() / kMostMarks;
  for (std::size_t i = 0; i < step.costs.size(); ++i) {
    const double cost = step.costs[i];
    if (!std::isfinite(cost) || (i % every != 0 && i + 1 != step.costs.size())) continue;
    if (cost > before * (1.0 + 1e-9)) {
      drawing.curve(places, "after thick");
      places.clear();
    }
    before = cost;
    places.push_back({x.at(first + static_cast<double>(i)), y.at(cost)});
    append_dot(dots, places.back());
  }
  drawing.curve(places, "after thick");
  if (dots.empty()) return;
  drawing.open_group("dots worst");
  drawing.path(dots, "");
  drawing.close_group();
}

/// The numbers of a step's iterations below the axis, from zero at its start.
/// @param last   number of its last iteration
/// @param first  where the step starts on the axis
void number_iterations(Drawing& drawing, std::size_t last, double first, const PlotArea& area,
                       const Axis& x) {
  constexpr double kApart = 45.0;
  const double room = x.at(first + static_cast<double>(last)) - x.at(first);
  const auto step = static_cast<std::size_t>(
      std::max(1.0, round_step(static_cast<double>(last), static_cast<int>(room / kApart))));
  for (std::size_t number = 0; number <= last; number += step) {
    const double at = x.at(first + static_cast<double>(number));
    drawing.line({at, area.bottom}, {at, area.bottom + 4.0}, "axis");
    drawing.text({at, area.bottom + 17.0}, fmt::format("{}", number), "tick", Anchor::middle);
  }
}

[[nodiscard]] std::string step_name(const StepResult& step, std::size_t number) {
  return step.name.empty() ? fmt::format("step {}", number) : step.name;
}

[[nodiscard]] std::string draw_convergence(const Chart& chart,
                                           const std::vector<StepResult>& steps) {
  const PlotArea area{56.0, 44.0, kChartWidth - 12.0, 236.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  double iterations = 0.0, first = 0.0;
  for (const StepResult& step : steps) iterations += static_cast<double>(step.costs.size());
  const Axis x = Axis::exact(-0.5, std::max(1.0, iterations - 0.5), area.left, area.right);
  const Axis y = cost_axis(steps, area.bottom, area.top);
  drawing.axis_y(area, y, "");
  drawing.text({2.0, 14.0}, "cost", "name");
  std::string description = "Costs.";
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const std::vector<double>& costs = steps[i].costs;
    if (costs.empty()) continue;
    const double begin = x.at(first - 0.5), end = x.at(first + double(costs.size()) - 0.5);
    if (first > 0.0) drawing.line({begin, area.top - 20.0}, {begin, area.bottom}, "faint");
    if (end - begin > 30.0) {
      drawing.name({begin + 4.0, area.top - 9.0}, step_name(steps[i], i + 1), end - begin - 6.0,
                   "small");
    }
    number_iterations(drawing, costs.size() - 1, first, area, x);
    draw_runs(drawing, steps[i], first, x, y);
    description += fmt::format(" {}: from {} to {} in {} iterations.",
                               shortened(step_name(steps[i], i + 1), 60), figure(costs.front(), 4),
                               figure(costs.back(), 4), costs.size() - 1);
    first += static_cast<double>(costs.size());
  }
  drawing.line({area.left, area.bottom}, {area.right, area.bottom}, "axis");
  drawing.text({area.right, area.bottom + 33.0}, "iterations", "name", Anchor::end);
  return drawing.str(description);
}

[[nodiscard]] std::string draw_minima(const Chart& chart, const StartSummary& starts,
                                      std::size_t shown) {
  constexpr double kRow = 22.0, kLeft = 96.0, kLongest = 250.0;
  Drawing drawing(chart.name, chart.title, 26.0 + kRow * double(shown));
  int most = 1;
  for (const FoundMinimum& minimum : starts.minima) most = std::max(most, minimum.solves);
  drawing.text({kLeft - 8.0, 14.0}, "cost", "name", Anchor::end);
  drawing.text({kLeft, 14.0}, "solves", "name");
  std::string description = fmt::format("{} minima.", starts.minima.size());
  for (std::size_t i = 0; i < shown; ++i) {
    const auto& [cost, solves] = starts.minima[i];
    const double y = 22.0 + kRow * double(i);
    const bool taken = starts.taken == static_cast<int>(i);
    const double length = std::max(1.0, kLongest * std::max(0, solves) / most);
    drawing.text({kLeft - 8.0, y + 14.0}, figure(cost, 4), "small figure", Anchor::end);
    drawing.rectangle({kLeft, y + 2.0}, length, 15.0, taken ? "good" : "faint");
    drawing.text({kLeft + length + 7.0, y + 14.0},
                 fmt::format("{}{}", solves, taken ? ", taken" : ""),
                 taken ? "small strong" : "small");
    description +=
        fmt::format(" Cost {}: {} solves{}.", figure(cost, 4), solves, taken ? ", taken" : "");
  }
  return drawing.str(description);
}

}  // namespace
}  // namespace detail

std::vector<Chart> convergence_charts(const ReportData& data) {
  const bool any = std::any_of(data.steps.begin(), data.steps.end(),
                               [](const StepResult& step) { return !step.costs.empty(); });
  if (!any) return {};
  Chart chart{"convergence", "convergence", "Cost",
              "Half the sum of weighted squares after each iteration.", ""};
  chart.svg = detail::draw_convergence(chart, data.steps);
  return {chart};
}

std::vector<Chart> start_charts(const ReportData& data) {
  constexpr std::size_t kMost = 12;
  std::vector<Chart> charts;
  for (std::size_t i = 0; i < data.steps.size(); ++i) {
    const StartSummary& starts = data.steps[i].starts;
    const std::size_t all = starts.minima.size(), shown = std::min(all, kMost);
    if (all == 0) continue;
    Chart chart{"convergence", fmt::format("starts-{}", i + 1),
                "Minima of several starts: " +
                    detail::shortened(detail::step_name(data.steps[i], i + 1), 60),
                "How many solves ended at each minimum.", ""};
    if (starts.failed > 0) chart.caption += fmt::format(" {} ended at none.", starts.failed);
    if (shown < all) chart.caption += fmt::format(" The lowest {} of {} are shown.", shown, all);
    chart.svg = detail::draw_minima(chart, starts, shown);
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace kinecal
