// Drawing which camera saw which pose.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal {

namespace detail {
namespace {

/// What a camera saw in a sample.
struct Sight {
  int features = 0;
  int compared = 0;      ///< of these, the ones of which noise and residual are known
  double squares = 0.0;  ///< of their distances in units of the expected one

  void add(double times) {
    ++features;
    if (!std::isfinite(times)) return;
    ++compared;
    squares += times * times;
  }
  /// Root of the mean square; NaN if it is not known.
  [[nodiscard]] double times() const { return std::sqrt(squares / compared); }
};

/// Sights by the index of their sample.
using Sights = std::map<int, Sight>;

/// The sights of each camera, in the order of the blocks.
[[nodiscard]] std::vector<std::pair<std::string, Sights>> sights_of_cameras(
    const ReportData& data) {
  std::vector<std::pair<std::string, Sights>> all;
  for (const ReportedBlock& block : data.blocks) {
    const double expected =
        expected_distance(block, block.sigma > 0.0 ? block.sigma : block.sigma_given);
    for (const std::string& camera : block.cameras) {
      auto of = std::find_if(all.begin(), all.end(),
                             [&](const auto& known) { return known.first == camera; });
      if (of == all.end()) of = all.insert(of, {camera, {}});
      for (const ReportedFeature& feature : block.features)
        of->second[feature.sample].add(feature.after / expected);  // not finite without noise
    }
  }
  return all;
}

/// The columns: indices of samples in the order of their numbers; of many, each n-th.
[[nodiscard]] std::vector<int> columns_of(const ReportData& data, std::size_t most) {
  std::vector<int> all(data.samples.size()), columns;
  std::iota(all.begin(), all.end(), 0);
  std::stable_sort(all.begin(), all.end(), [&](int a, int b) {
    return data.samples[static_cast<std::size_t>(a)].number <
           data.samples[static_cast<std::size_t>(b)].number;
  });
  const std::size_t step = std::max<std::size_t>(1, (all.size() + most - 1) / most);
  for (std::size_t i = 0; i < all.size(); i += step) columns.push_back(all[i]);
  return columns;
}

constexpr double kExplained = 1.5, kFarOff = 3.0;  // times what noise explains

[[nodiscard]] const char* class_of_sight(const Sight& sight) {
  const double times = sight.times();
  return !std::isfinite(times) ? "faint l2"
         : times <= kExplained ? "after l2"
         : times <= kFarOff    ? "after"
                               : "bad";
}

[[nodiscard]] std::string sight_text(const std::string& camera, const ReportedSample& sample,
                                     const Sight& sight) {
  std::string text = fmt::format("{}, sample {}: {}", shortened(camera, 40), sample.number,
                                 counted(static_cast<std::size_t>(sight.features), "feature"));
  if (std::isfinite(sight.times())) text += fmt::format(", {:.1f} times the noise", sight.times());
  return text + (sample.left_out ? ", left out" : "");
}

[[nodiscard]] std::string cameras_description(
    const std::vector<std::pair<std::string, Sights>>& all, std::size_t samples) {
  std::string text =
      fmt::format("What {} cameras saw of {}:", all.size(), counted(samples, "sample"));
  for (const auto& [camera, sights] : all) {
    text += fmt::format("{} {} {}", &camera == &all.front().first ? "" : ",", shortened(camera, 40),
                        sights.size());
  }
  return text + ".";
}

}  // namespace
}  // namespace detail

std::vector<Chart> camera_charts(const ReportData& data) {
  const auto all = detail::sights_of_cameras(data);
  if (all.size() < 2) return {};
  Chart chart{"residuals", "cameras", "Which camera saw which pose",
              "A row for each camera, a column for each sample in capture order.", ""};
  const std::vector<int> columns = detail::columns_of(data, detail::kMostMarks / all.size());
  if (columns.size() < data.samples.size()) {
    chart.caption +=
        fmt::format(" {} of {} samples are shown.", columns.size(), data.samples.size());
  }
  constexpr double kNames = 110.0, kLegend = 26.0, kRow = 18.0, kMostWide = 14.0;
  const double wide = std::min(
      kMostWide, (detail::kChartWidth - kNames - 4.0) / static_cast<double>(columns.size()));
  const double gap = wide > 4.0 ? 1.0 : 0.0;
  detail::Drawing drawing(chart.name, chart.title,
                          kLegend + kRow * static_cast<double>(all.size()) + 4.0);
  detail::draw_legend(drawing,
                      {{detail::Swatch::square, "after l2", "seen, as noise explains"},
                       {detail::Swatch::square, "after", "over 1.5 times"},
                       {detail::Swatch::square, "bad", "over 3 times"}},
                      2.0);
  for (std::size_t row = 0; row < all.size(); ++row) {
    const auto& [camera, sights] = all[row];
    const double y = kLegend + kRow * static_cast<double>(row);
    drawing.name({kNames - 6.0, y + 13.0}, camera, kNames - 8.0, "small", detail::Anchor::end);
    drawing.rectangle({kNames, y}, wide * static_cast<double>(columns.size()), kRow - 3.0,
                      "pale l2");
    for (std::size_t column = 0; column < columns.size(); ++column) {
      const auto seen = sights.find(columns[column]);
      if (seen == sights.end()) continue;
      const ReportedSample& sample = data.samples[static_cast<std::size_t>(columns[column])];
      drawing.rectangle({kNames + wide * static_cast<double>(column), y}, wide - gap, kRow - 3.0,
                        detail::class_of_sight(seen->second),
                        detail::sight_text(camera, sample, seen->second), sample.number);
    }
  }
  chart.svg = drawing.str(detail::cameras_description(all, data.samples.size()));
  return {chart};
}

}  // namespace kinecal
