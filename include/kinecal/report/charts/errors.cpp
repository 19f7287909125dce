// Drawing distributions of errors.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/charts/density.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A block's distances, finite and sorted.
struct BlockErrors {
  const ReportedBlock* block = nullptr;
  std::vector<double> before, after;  ///< in the unit for people
};

[[nodiscard]] BlockErrors errors_of(const ReportData& data, const ReportedBlock& block) {
  std::vector<double> before, after;
  for (const ReportedFeature& feature : block.features) {
    if (sample_of(data, feature).left_out) continue;
    before.push_back(people_factor(block.unit) * std::abs(feature.before));
    after.push_back(people_factor(block.unit) * std::abs(feature.after));
  }
  return {&block, sorted_finite(before), sorted_finite(after)};
}

/// From the smallest hundredth to the largest of all, at most five decades.
[[nodiscard]] Axis errors_axis(const std::vector<BlockErrors>& all, double from, double to) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  const auto include = [&](double a, double b) {
    if (a > 0.0 && std::isfinite(a)) low = std::min(low, a);
    if (std::isfinite(b)) high = std::max(high, b);
  };
  for (const BlockErrors& errors : all) {
    for (const auto* list : {&errors.before, &errors.after}) {
      if (!list->empty()) include(quantile(*list, 0.01), list->back());
    }
    const double factor = people_factor(errors.block->unit);
    for (const double sigma : {errors.block->sigma, errors.block->sigma_given}) {
      const double expected = factor * expected_distance(*errors.block, sigma);
      if (sigma > 0.0) include(expected, expected);
    }
  }
  constexpr double kDecades = 1e-5, kMargin = 1.5;
  return Axis::logarithmic(std::max(low / kMargin, kDecades * high), kMargin * high, from, to);
}

void draw_errors_row(Drawing& drawing, const BlockErrors& errors, const Axis& x, double top,
                     double bottom) {
  const ReportedBlock& block = *errors.block;
  const std::string unit = people_unit(block.unit);
  const std::string medians =
      fmt::format("median {} → {}{}", figure(quantile(errors.before, 0.5)),
                  figure(quantile(errors.after, 0.5)), unit.empty() ? "" : " " + unit);
  const double room = kChartWidth - 20.0 - kFontSize * text_width(medians);
  drawing.name({2.0, top + 14.0}, block.name, room, "strong");
  drawing.text({kChartWidth - 10.0, top + 14.0}, medians, "figure", Anchor::end);
  const auto before = density_of(errors.before, x), after = density_of(errors.after, x);
  const double highest = std::max(*std::max_element(before.begin(), before.end()),
                                  *std::max_element(after.begin(), after.end()));
  const double height = (bottom - top - 32.0) / std::max(highest, 1e-12);
  draw_density(drawing, before, errors.before, x, bottom - 6.0, height, true);
  draw_density(drawing, after, errors.after, x, bottom - 6.0, height, false);
  const auto noise_line = [&](double sigma, const char* classes) {
    if (!(sigma > 0.0) || !std::isfinite(sigma)) return;
    const double at = x.at(people_factor(block.unit) * expected_distance(block, sigma));
    drawing.line({at, top + 22.0}, {at, bottom - 6.0}, classes);
  };
  noise_line(block.sigma_given, "given");
  noise_line(block.sigma, "sigma");
  drawing.line({x.from(), bottom - 6.0}, {x.to(), bottom - 6.0}, "faint");
}

[[nodiscard]] std::string errors_description(const std::vector<BlockErrors>& all) {
  std::string text = "Distances of features, logarithmic.";
  for (const BlockErrors& errors : all) {
    const std::string unit = people_unit(errors.block->unit);
    text += fmt::format(" {}: median {} before, {} after, 95 % below {} {}, {} features.",
                        shortened(errors.block->name, 40), figure(quantile(errors.before, 0.5)),
                        figure(quantile(errors.after, 0.5)), figure(quantile(errors.after, 0.95)),
                        unit, count_text(errors.after.size()));
  }
  return text;
}

[[nodiscard]] Chart errors_chart(const std::vector<BlockErrors>& all, const std::string& unit) {
  constexpr double kRow = 96.0;
  Chart chart{"errors", name_with_unit("errors", unit), "Errors before and after",
              "Distances of all features, the curves' areas are equal; the figures and short bars "
              "are medians. Dashed: the distance that noise alone makes one expect.",
              ""};
  const PlotArea area{10.0, 28.0, kChartWidth - 10.0, 28.0 + kRow * double(all.size())};
  Drawing drawing(chart.name, chart.title, area.bottom + 40.0);
  const Axis x = errors_axis(all, area.left, area.right);
  std::vector<LegendEntry> legend = {{Swatch::square, "before", "before"},
                                     {Swatch::square, "after", "after"}};
  const auto any = [&](double ReportedBlock::*sigma) {
    return std::any_of(all.begin(), all.end(),
                       [&](const BlockErrors& e) { return e.block->*sigma > 0.0; });
  };
  if (any(&ReportedBlock::sigma)) legend.push_back({Swatch::line, "sigma", "noise, estimated"});
  if (any(&ReportedBlock::sigma_given)) legend.push_back({Swatch::line, "given", "noise, given"});
  draw_legend(drawing, legend, 2.0);
  drawing.axis_x(area, x, axis_name("distance", unit));
  double top = area.top;
  for (const BlockErrors& errors : all) {
    draw_errors_row(drawing, errors, x, top, top + kRow);
    top += kRow;
  }
  chart.svg = drawing.str(errors_description(all));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> error_charts(const ReportData& data) {
  std::vector<Chart> charts;
  for (const std::string& unit : detail::units_of(data)) {
    std::vector<detail::BlockErrors> all;
    for (const ReportedBlock& block : data.blocks) {
      if (block.unit != unit) continue;
      detail::BlockErrors errors = detail::errors_of(data, block);
      if (!errors.before.empty() || !errors.after.empty()) all.push_back(std::move(errors));
    }
    if (!all.empty()) charts.push_back(detail::errors_chart(all, unit));
  }
  return charts;
}

}  // namespace kinecal
