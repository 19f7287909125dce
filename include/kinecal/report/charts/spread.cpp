// Drawing how calibrations vary.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/spread.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/trust/f_distribution.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] bool is_ratio(double ratio) {
  return std::isfinite(ratio) && ratio > 0.0;
}

/// The ratio of a series; NaN if absent.
[[nodiscard]] double ratio_of(const SpreadSeries& series, std::size_t parameter) {
  const bool has = parameter < series.ratios.size() && is_ratio(series.ratios[parameter]);
  return has ? series.ratios[parameter] : std::numeric_limits<double>::quiet_NaN();
}

/// The parameters to draw, in order: of many, those farthest from one.
[[nodiscard]] std::vector<std::size_t> spread_rows(const SpreadRatios& ratios) {
  constexpr std::size_t kMost = 60;
  std::vector<double> sizes(ratios.parameters.size(), 0.0);
  for (std::size_t p = 0; p < sizes.size(); ++p) {
    for (const SpreadSeries& series : ratios.series) {
      const double ratio = ratio_of(series, p);
      if (is_ratio(ratio)) sizes[p] = std::max(sizes[p], std::abs(std::log(ratio)));
    }
  }
  std::vector<std::size_t> rows(sizes.size());
  for (std::size_t p = 0; p < rows.size(); ++p) rows[p] = p;
  if (rows.size() <= kMost) return rows;
  std::stable_sort(rows.begin(), rows.end(),
                   [&](std::size_t a, std::size_t b) { return sizes[a] > sizes[b]; });
  rows.resize(kMost);
  std::sort(rows.begin(), rows.end());
  return rows;
}

/// Ratios, with one in the middle.
[[nodiscard]] Axis ratio_axis(const SpreadRatios& ratios, double left, double right) {
  constexpr double kFarthest = 30.0;
  double reach = 2.0;
  for (const SpreadSeries& series : ratios.series) {
    if (series.freedom > 0) reach = std::max(reach, 1.0 / spread_interval(series.freedom).first);
    for (const double ratio : series.ratios) {
      if (is_ratio(ratio)) reach = std::max({reach, ratio, 1.0 / ratio});
    }
  }
  reach = std::min(1.1 * reach, kFarthest);
  return Axis::logarithmic(1.0 / reach, reach, left, right);
}

/// " 2 of 34 parameters are outside ..." of the first series.
[[nodiscard]] std::string outside_text(const SpreadSeries& series) {
  if (series.freedom <= 0) return "";
  constexpr double kShare = 0.05;
  const auto [low, high] = spread_interval(series.freedom);
  int all = 0, outside = 0;
  for (const double ratio : series.ratios) {
    if (!is_ratio(ratio)) continue;
    ++all;
    if (ratio < low || ratio > high) ++outside;
  }
  return fmt::format(
      " Figures are those of {}: {} of {} determined parameters are outside of the interval, where "
      "chance alone takes {:.1f} on average; parameters that err together leave it together.",
      shortened(series.name, 40), outside, all, kShare * all);
}

/// Dots and figure of a parameter.
void draw_spread_row(Drawing& drawing, const SpreadRatios& ratios, std::size_t parameter,
                     const Axis& x, double middle) {
  const std::string& name = ratios.parameters[parameter];
  drawing.name({x.from() - 10.0, middle + 4.0}, name, x.from() - 14.0, "small", Anchor::end);
  bool any = false;
  for (std::size_t s = ratios.series.size(); s-- > 0;) {  // the first on top
    const double ratio = ratio_of(ratios.series[s], parameter);
    if (!is_ratio(ratio)) continue;
    any = true;
    drawing.circle({x.at(ratio), middle}, s == 0 ? 4.0 : 5.0, s == 0 ? "after" : "ring before", 0,
                   fmt::format("{}, {}: {}", name, ratios.series[s].name, figure(ratio)));
  }
  const double right = kChartWidth - 4.0;
  if (any && !ratios.series.empty() && is_ratio(ratio_of(ratios.series[0], parameter))) {
    drawing.text({right, middle + 4.0},
                 fmt::format("{:.2f}", ratio_of(ratios.series[0], parameter)), "small figure",
                 Anchor::end);
  } else if (!any) {
    drawing.text({x.from() + 6.0, middle + 4.0}, "not determined", "small quiet");
  }
}

/// The axis, the range of chance, and the line at one.
void draw_ratio_axis(Drawing& drawing, const SpreadRatios& ratios, const PlotArea& area,
                     const Axis& x) {
  if (!ratios.series.empty() && ratios.series[0].freedom > 0) {
    const auto [low, high] = spread_interval(ratios.series[0].freedom);
    drawing.rectangle({x.at(low), area.top}, x.at(high) - x.at(low), area.bottom - area.top,
                      "pale");
  }
  drawing.axis_x(area, x, "varied / predicted");
  drawing.line({x.at(1.0), area.top}, {x.at(1.0), area.bottom}, "zero");
}

[[nodiscard]] std::vector<LegendEntry> spread_legend(const SpreadRatios& ratios) {
  std::vector<LegendEntry> entries;
  for (std::size_t s = 0; s < ratios.series.size(); ++s) {
    entries.push_back({s == 0 ? Swatch::dot : Swatch::ring, s == 0 ? "after" : "ring before",
                       shortened(ratios.series[s].name, 40)});
  }
  entries.push_back({Swatch::square, "pale", "95 % by chance"});
  return entries;
}

}  // namespace
}  // namespace detail

std::pair<double, double> spread_interval(int freedom, double tail) {
  const auto ratio_above = [&](double share) {  // of the studies; it falls with the ratio
    return std::sqrt(chi_square_exceeded(freedom, share) / freedom);
  };
  return {ratio_above(1.0 - tail), ratio_above(tail)};
}

Chart spread_chart(const SpreadRatios& ratios) {
  Chart chart{"repeatability", "spread", "Parameters: as predicted?",
              "Standard deviation of the calibrations, divided by the one that the covariance "
              "predicts. If the covariance is right, 95 of 100 dots are in the grey interval.",
              ""};
  const std::vector<std::size_t> rows = detail::spread_rows(ratios);
  const std::string outside =
      ratios.series.empty() ? std::string() : detail::outside_text(ratios.series[0]);
  chart.caption += outside;
  if (rows.size() < ratios.parameters.size()) {
    chart.caption += fmt::format(" The {} farthest from one of {} parameters are shown.",
                                 rows.size(), ratios.parameters.size());
  }
  const std::vector<detail::LegendEntry> entries = detail::spread_legend(ratios);
  constexpr double kRow = 20.0, kLeft = 186.0, kFigures = 44.0;
  detail::Drawing measured("", "", 0.0);  // to measure the height of the legend
  const double top = detail::draw_legend(measured, entries, 0.0) + 6.0;
  const detail::PlotArea area{kLeft, top, detail::kChartWidth - kFigures,
                              top + 6.0 + kRow * static_cast<double>(rows.size())};
  detail::Drawing drawing(chart.name, chart.title, area.bottom + 40.0);
  detail::draw_legend(drawing, entries, 0.0);
  const detail::Axis x = detail::ratio_axis(ratios, area.left, area.right);
  detail::draw_ratio_axis(drawing, ratios, area, x);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    detail::draw_spread_row(drawing, ratios, rows[i], x,
                            area.top + 3.0 + kRow * (static_cast<double>(i) + 0.5));
  }
  chart.svg = drawing.str("Standard deviation of the calibrations by the predicted one." + outside);
  return chart;
}

}  // namespace kinecal
