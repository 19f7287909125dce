// Drawing correlations.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/correlation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Correlation of two parameters; NaN if the matrix lacks it.
[[nodiscard]] double correlation_of(const ReportData& data, std::size_t i, std::size_t j) {
  const bool has = i < data.correlation.size() && j < data.correlation[i].size();
  return has ? data.correlation[i][j] : std::numeric_limits<double>::quiet_NaN();
}

/// All parameters, or those with the largest correlations, in the order of the data.
[[nodiscard]] std::vector<std::size_t> most_correlated(const ReportData& data) {
  constexpr std::size_t kMost = 60;
  std::vector<std::size_t> chosen(data.correlated.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  if (chosen.size() <= kMost) return chosen;
  std::vector<double> largest(chosen.size(), 0.0);
  for (const std::size_t i : chosen) {
    for (std::size_t j = 0; j < i; ++j) {
      const double size = std::abs(correlation_of(data, i, j));
      if (!std::isfinite(size)) continue;
      largest[i] = std::max(largest[i], size);
      largest[j] = std::max(largest[j], size);
    }
  }
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](std::size_t a, std::size_t b) { return largest[a] > largest[b]; });
  chosen.resize(kMost);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

/// CSS class of a value from -1 to 1; empty if it is too small to draw.
[[nodiscard]] std::string correlation_class(double value) {
  const double size = std::abs(value);
  if (!(size >= 0.1)) return "";
  const char* level = size >= 0.9   ? ""
                      : size >= 0.7 ? " l4"
                      : size >= 0.5 ? " l3"
                      : size >= 0.3 ? " l2"
                                    : " l1";
  return (value < 0.0 ? "minus" : "plus") + std::string(level);
}

void draw_cells(Drawing& drawing, const ReportData& data, const std::vector<std::size_t>& chosen,
                ChartPoint corner, double cell) {
  for (std::size_t row = 0; row < chosen.size(); ++row) {
    const double y = corner[1] + cell * static_cast<double>(row) + 0.5;
    for (std::size_t column = 0; column <= row; ++column) {
      const double x = corner[0] + cell * static_cast<double>(column) + 0.5;
      const double value = correlation_of(data, chosen[row], chosen[column]);
      const std::string classes = row == column ? "pale" : correlation_class(value);
      if (classes.empty()) continue;
      std::string title;
      if (row != column) {
        title = fmt::format("{}, {}: {}", shortened(data.correlated[chosen[row]], 40),
                            shortened(data.correlated[chosen[column]], 40), figure(value, 2));
      }
      drawing.rectangle({x, y}, cell - 1.0, cell - 1.0, classes.c_str(), title);
    }
  }
}

[[nodiscard]] std::string correlation_description(const ReportData& data,
                                                  const std::vector<std::size_t>& chosen) {
  std::size_t first = 0, second = 0;
  double largest = 0.0;
  for (const std::size_t i : chosen) {
    for (const std::size_t j : chosen) {
      const double value = correlation_of(data, i, j);
      if (j >= i || !(std::abs(value) > std::abs(largest))) continue;
      largest = value;
      first = i;
      second = j;
    }
  }
  std::string text = fmt::format("Correlations of {} parameters.", chosen.size());
  if (largest != 0.0) {
    text += fmt::format(" The largest: {} and {}, {}.", shortened(data.correlated[first], 60),
                        shortened(data.correlated[second], 60), figure(largest, 2));
  }
  return text;
}

[[nodiscard]] std::string draw_correlation(const Chart& chart, const ReportData& data,
                                           const std::vector<std::size_t>& chosen) {
  constexpr double kNames = 138.0, kLeastCell = 14.0, kMostCell = 30.0, kLegend = 24.0;
  const double n = static_cast<double>(chosen.size());
  const double cell = std::clamp((kChartWidth - kNames - 4.0) / n, kLeastCell, kMostCell);
  const double width = std::max(kChartWidth, kNames + n * cell + 4.0), bottom = kLegend + n * cell;
  Drawing drawing(chart.name, chart.title, bottom + kNames, width);
  draw_cells(drawing, data, chosen, {kNames, kLegend}, cell);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const double at = cell * (static_cast<double>(i) + 0.5) + 4.0;
    const std::string& name = data.correlated[chosen[i]];
    drawing.name({kNames - 5.0, kLegend + at}, name, kNames - 8.0, "small", Anchor::end);
    drawing.name({kNames + at, bottom + 5.0}, name, kNames - 8.0, "small", Anchor::end, -90.0);
  }
  draw_legend(drawing,
              {{Swatch::square, "minus", "−1"},
               {Swatch::square, "minus l3", "−0.5"},
               {Swatch::square, "plus l3", "0.5"},
               {Swatch::square, "plus", "1"}},
              2.0, kNames);
  return drawing.str(correlation_description(data, chosen));
}

}  // namespace
}  // namespace detail

std::vector<Chart> correlation_charts(const ReportData& data) {
  const auto chosen = detail::most_correlated(data);
  if (chosen.size() < 2) return {};
  Chart chart{"parameters", "correlation", "Correlations of parameters",
              "Strong colours: the samples show these parameters together rather than each alone.",
              ""};
  if (chosen.size() < data.correlated.size()) {
    chart.caption += fmt::format(" The {} most correlated of {} parameters are shown.",
                                 chosen.size(), data.correlated.size());
  }
  chart.svg = detail::draw_correlation(chart, data, chosen);
  return {chart};
}

}  // namespace kinecal
