// Axes of distances.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/distance_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kinecal::detail {

std::vector<double> distances_of(const ReportedBlock& block) {
  std::vector<double> distances;
  distances.reserve(block.features.size());
  for (const ReportedFeature& feature : block.features) {
    distances.push_back(people_factor(block.unit) * std::abs(feature.after));
  }
  return distances;
}

std::vector<double> used_distances(const ReportData& data, const ReportedBlock& block) {
  std::vector<double> distances = distances_of(block);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const bool left_out = sample_of(data, block.features[i]).left_out;
    if (left_out) distances[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return distances;
}

Axis distance_axis(const ReportedBlock& block, const std::vector<double>& sorted, double bottom,
                   double top) {
  const double factor = people_factor(block.unit);
  const double noise = factor * expected_distance(block, std::max(0.0, block.sigma));
  const double most = std::max(sorted.empty() ? 0.0 : sorted.back(), 1.1 * noise);
  const double median = quantile(sorted, 0.5);
  constexpr double kFarOff = 15.0;  // the others would be flat
  if (median > 0.0 && most > kFarOff * median) {
    const double least = std::max(quantile(sorted, 0.02), 1e-2 * median);
    return Axis::logarithmic(0.8 * least, 1.2 * most, bottom, top);
  }
  return Axis::linear(0.0, most, bottom, top);
}

Axis samples_axis(const ReportData& data, const ReportedBlock& block, const PlotArea& area) {
  int first = std::numeric_limits<int>::max(), last = 0;
  const auto include = [&](int number) {
    if (number <= 0) return;
    first = std::min(first, number);
    last = std::max(last, number);
  };
  for (const ReportedSample& sample : data.samples) include(sample.number);
  for (const ReportedFeature& feature : block.features) include(sample_number(data, feature));
  const double room = std::max(0.6, 0.012 * (last - first));
  return Axis::exact(first - room, last + room, area.left, area.right);
}

/// Where a multiple of the distance expected from noise is on an axis; NaN if it is beyond.
[[nodiscard]] inline double noise_on_axis(const Axis& y, const ReportedBlock& block, double times) {
  const double noise = times * people_factor(block.unit) * expected_distance(block, block.sigma);
  const bool is_drawn = noise > 0.0 && noise >= y.low() && noise <= y.high();
  return is_drawn ? y.at(noise) : std::numeric_limits<double>::quiet_NaN();
}

void draw_noise_lines(Drawing& drawing, const PlotArea& area, const Axis& y,
                      const ReportedBlock& block) {
  for (const double times : {1.0, 3.0}) {
    const double at = noise_on_axis(y, block, times);
    if (!std::isfinite(at)) continue;
    drawing.line({area.left, at}, {area.right, at}, times == 1.0 ? "sigma" : "given");
  }
}

std::vector<LegendEntry> noise_entries(const Axis& y, const ReportedBlock& block) {
  std::vector<LegendEntry> entries;
  if (std::isfinite(noise_on_axis(y, block, 1.0))) {
    entries.push_back({Swatch::line, "sigma", "noise"});
  }
  if (std::isfinite(noise_on_axis(y, block, 3.0))) {
    entries.push_back({Swatch::line, "given", "3 × noise"});
  }
  return entries;
}

}  // namespace kinecal::detail
