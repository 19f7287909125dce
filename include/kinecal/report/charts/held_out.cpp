// Drawing held-out errors.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/held_out.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/report/text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A bar of held_out_charts().
struct ErrorBar {
  const char* text;
  const char* classes;
  double value;
};

/// The bars of a block that have a figure.
[[nodiscard]] std::vector<ErrorBar> error_bars(const ReportedBlock& block) {
  const double factor = people_factor(block.unit);
  std::vector<ErrorBar> bars = {{"before", "before", factor * block.rms_before},
                                {"fitted", "after", factor * block.rms_after}};
  if (block.held_out) bars.push_back({"held out", "held", factor * *block.held_out});
  std::erase_if(bars, [](const ErrorBar& bar) { return !std::isfinite(bar.value); });
  return bars;
}

/// "hand_eye: before 5.1, fitted 0.31, held out 0.33 mm."
[[nodiscard]] std::string bars_text(const ReportedBlock& block) {
  std::string text;
  for (const ErrorBar& bar : error_bars(block)) {
    text += fmt::format("{} {} {}", text.empty() ? "" : ",", bar.text, figure(bar.value));
  }
  return fmt::format(" {}:{} {}.", shortened(block.name, 40), text, people_unit(block.unit));
}

[[nodiscard]] Chart held_out_chart(const std::vector<const ReportedBlock*>& blocks,
                                   const std::string& unit) {
  Chart chart{"errors", name_with_unit("held-out", unit), "Fitted and held-out errors",
              "Root of the mean squared distance. A held-out error much larger than the fitted one "
              "means that the samples are too few for the parameters.",
              ""};
  constexpr double kTitle = 24.0, kBar = 18.0, kLeft = 66.0, kFigure = 84.0;
  double largest = 0.0, height = 8.0;
  for (const ReportedBlock* block : blocks) {
    for (const ErrorBar& bar : error_bars(*block)) largest = std::max(largest, bar.value);
    height += kTitle + kBar * double(error_bars(*block).size()) + 8.0;
  }
  Drawing drawing(chart.name, chart.title, height);
  const Axis x = Axis::exact(0.0, largest, kLeft, kChartWidth - kFigure);
  double y = 4.0;
  std::string description = "Root of the mean squared distance.";
  for (const ReportedBlock* block : blocks) {
    drawing.name({2.0, y + 15.0}, block->name, kChartWidth - 10.0, "strong");
    y += kTitle;
    for (const ErrorBar& bar : error_bars(*block)) {
      drawing.text({kLeft - 7.0, y + 12.0}, bar.text, "small", Anchor::end);
      drawing.rectangle({kLeft, y + 1.0}, std::max(1.0, x.at(bar.value) - kLeft), kBar - 5.0,
                        bar.classes);
      drawing.text({std::max(kLeft + 1.0, x.at(bar.value)) + 6.0, y + 12.0},
                   in_reading_unit(bar.value / people_factor(unit), unit) +
                       (unit == "1" ? "" : " " + reading_unit(unit)),
                   "small figure");
      y += kBar;
    }
    drawing.line({kLeft, y - kBar * double(error_bars(*block).size()) - 1.0}, {kLeft, y - 2.0},
                 "axis");
    y += 8.0;
    description += bars_text(*block);
  }
  chart.svg = drawing.str(description);
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> held_out_charts(const ReportData& data) {
  std::vector<Chart> charts;
  for (const std::string& unit : detail::units_of(data)) {
    std::vector<const ReportedBlock*> blocks;
    for (const ReportedBlock& block : data.blocks) {
      if (block.unit == unit && !detail::error_bars(block).empty()) blocks.push_back(&block);
    }
    if (!blocks.empty()) charts.push_back(detail::held_out_chart(blocks, unit));
  }
  return charts;
}

}  // namespace kinecal
