// Drawing densities.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/density.hpp"

#include <cmath>
#include <numbers>

#include "kinecal/report/charts/chart.hpp"

namespace kinecal::detail {

std::array<double, kDensityBins> density_of(const std::vector<double>& values, const Axis& x) {
  std::array<double, kDensityBins> counts{}, density{};
  double sum = 0.0, squares = 0.0;
  for (const double value : values) {
    const double share = (x.at(value) - x.from()) / (x.to() - x.from()) * (kDensityBins - 1);
    counts[static_cast<std::size_t>(std::lround(share))] += 1.0 / double(values.size());
    sum += share;
    squares += share * share;
  }
  const double n = std::max(1.0, double(values.size())), mean = sum / n;
  const double deviation = std::sqrt(std::max(0.0, squares / n - mean * mean));
  constexpr double kNarrowest = 1.5;  // bins
  const double width = std::max(kNarrowest, 1.06 * deviation * std::pow(n, -0.2));
  std::array<double, kDensityBins> kernel{};
  for (int i = 0; i < kDensityBins; ++i) {
    kernel[i] =
        std::exp(-0.5 * (i / width) * (i / width)) / (width * std::sqrt(2.0 * std::numbers::pi));
  }
  for (int i = 0; i < kDensityBins; ++i) {
    if (counts[i] == 0.0) continue;
    for (int j = 0; j < kDensityBins; ++j) density[j] += counts[i] * kernel[std::abs(i - j)];
  }
  return density;
}

void draw_density(Drawing& drawing, const std::array<double, kDensityBins>& density,
                  const std::vector<double>& values, const Axis& x, double base, double height,
                  bool is_before) {
  if (values.empty()) return;
  std::vector<ChartPoint> outline;
  constexpr double kNothing = 0.3;  // of a pixel
  for (int i = 0; i < kDensityBins; ++i) {
    const double at = x.from() + (x.to() - x.from()) * i / (kDensityBins - 1);
    const bool first = outline.empty();
    const bool seen = height * density[i] > kNothing;
    if (!seen && (first || height * density[i - 1] <= kNothing)) continue;
    if (first) outline.push_back({at, base});
    outline.push_back({at, seen ? base - height * density[i] : base});
  }
  if (outline.empty()) return;
  outline.push_back({outline.back()[0], base});
  drawing.area(outline, is_before ? "area before" : "area after");
  const double median = x.at(quantile(values, 0.5));
  drawing.line({median, base + 5.0}, {median, base - 9.0},
               is_before ? "before thick" : "after thick");
}

}  // namespace kinecal::detail
