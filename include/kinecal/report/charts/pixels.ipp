// Drawing residuals in images.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/report/charts/image_place.hpp"
#include "kinecal/report/charts/pixels.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {

/// From pixels of the image to the chart, and how much longer arrows are drawn.
struct ImageScale {
  Place corner = {0.0, 0.0};  ///< of the image in the chart
  Place low = {0.0, 0.0};     ///< of the image, pixels
  double pixel = 1.0;         ///< length of a pixel in the chart
  double times = 1.0;         ///< arrows are longer by this

  [[nodiscard]] Place at(double x, double y) const {
    return {corner[0] + pixel * (x - low[0]), corner[1] + pixel * (y - low[1])};
  }
};

/// A round factor with which nearly all arrows are at most a twelfth of the chart.
[[nodiscard]] inline double arrow_times(const std::vector<double>& sorted, double pixel) {
  const double usual = quantile(sorted, 0.95);
  if (!(usual > 0.0)) return 1.0;
  const double most = kChartWidth / 12.0 / (pixel * usual);
  const double step = round_step(most, 1);
  return step > most * 1.5 ? 0.5 * step : step;
}

/// An arrow as a path; one that is too short for a head has none.
inline void append_arrow(std::string& path, Place from, Place to) {
  constexpr double kMost = 100.0;
  double x = to[0] - from[0], y = to[1] - from[1];
  const double length = std::hypot(x, y);
  if (length > kMost) {
    x *= kMost / length;
    y *= kMost / length;
  }
  const Place end = {from[0] + x, from[1] + y};
  path += "M" + coordinate(from[0]) + " " + coordinate(from[1]) + "L" + coordinate(end[0]) + " " +
          coordinate(end[1]);
  if (length < 3.0) return;
  const double size = std::min(4.5, 0.4 * length) / std::min(length, kMost);
  const auto wing = [&](double side) {
    return coordinate(end[0] - size * (x - 0.6 * side * y)) + " " +
           coordinate(end[1] - size * (y + 0.6 * side * x));
  };
  path += "M" + wing(1.0) + "L" + coordinate(end[0]) + " " + coordinate(end[1]) + "L" + wing(-1.0);
}

inline void draw_arrows(Drawing& drawing, const ReportData& data,
                        const std::vector<const ReportedFeature*>& features,
                        const std::vector<std::size_t>& chosen, const ImageScale& scale) {
  for (const bool bad : {false, true}) {
    drawing.open_group(bad ? "arrows bad" : "arrows");
    for (const std::size_t i : chosen) {
      const ReportedFeature& feature = *features[i];
      if (sample_of(data, feature).bad != bad) continue;
      const auto [x, y] = *feature.pixel;
      std::string path;
      append_arrow(
          path, scale.at(x, y),
          scale.at(x + scale.times * feature.residual[0], y + scale.times * feature.residual[1]));
      drawing.path(path, "", sample_number(data, feature));
    }
    drawing.close_group();
  }
}

/// An arrow of a round length in pixels.
inline void draw_arrow_key(Drawing& drawing, const ImageScale& scale, double y) {
  constexpr double kLongest = 60.0;
  const double longest = kLongest / (scale.pixel * scale.times);
  const double step = round_step(longest, 1);
  const double length = step > longest ? 0.5 * step : step;
  std::string path;
  append_arrow(path, {8.0, y}, {8.0 + length * scale.pixel * scale.times, y});
  drawing.open_group("arrows");
  drawing.path(path, "");
  drawing.close_group();
  drawing.text({16.0 + length * scale.pixel * scale.times, y + 4.0},
               fmt::format("{} px, from observed to predicted; {} times as long", figure(length),
                           figure(scale.times)),
               "small");
}

[[nodiscard]] inline Chart pixel_chart(const ReportData& data, const ReportedBlock& block,
                                       const std::string& slug,
                                       const std::vector<const ReportedFeature*>& features) {
  constexpr std::size_t kMostArrows = 1000;
  std::vector<double> sizes;
  for (const ReportedFeature* f : features)
    sizes.push_back(std::hypot(f->residual[0], f->residual[1]));
  const std::vector<double> sorted = sorted_finite(sizes);
  const std::vector<std::size_t> chosen = chosen_marks(sizes, kMostArrows);
  Chart chart{"pixels", "pixels-" + slug, "Residuals in the image: " + block.name,
              "Arrows that point the same way in a region show a lens error; red: samples that do "
              "not fit." +
                  chosen_text(chosen.size(), features.size(), "features"),
              ""};
  const ImageFrame frame = image_frame(block, features);
  const double width = frame.high[0] - frame.low[0], height = frame.high[1] - frame.low[1];
  constexpr double kMargin = 8.0, kTop = 28.0, kMostHeight = 420.0;
  ImageScale scale{{kMargin, kTop}, frame.low};
  scale.pixel = std::min((kChartWidth - 2.0 * kMargin) / width, kMostHeight / height);
  scale.times = arrow_times(sorted, scale.pixel);
  scale.corner[0] = 0.5 * (kChartWidth - scale.pixel * width);
  const double bottom = kTop + scale.pixel * height;
  Drawing drawing(chart.name, chart.title, bottom + 24.0);
  drawing.rectangle(scale.corner, scale.pixel * width, scale.pixel * height, "frame");
  draw_arrow_key(drawing, scale, 12.0);
  draw_arrows(drawing, data, features, chosen, scale);
  drawing.text({scale.corner[0], bottom + 17.0},
               fmt::format("{} × {} px{}", figure(width, 4), figure(height, 4),
                           frame.is_known ? "" : ", what the features cover"),
               "small quiet");
  chart.svg = drawing.str(fmt::format(
      "Residuals of {} features as arrows in the image. Median {} px, 95 % below {} px, largest {} "
      "px.",
      count_text(features.size()), figure(quantile(sorted, 0.5)), figure(quantile(sorted, 0.95)),
      figure(sorted.back())));
  return chart;
}

}  // namespace detail

KINECAL_INLINE std::vector<Chart> pixel_charts(const ReportData& data) {
  std::vector<Chart> charts;
  const std::vector<std::string> slugs = detail::block_slugs(data);
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    const auto features = detail::features_in_image(data, data.blocks[b]);
    if (features.empty()) continue;
    charts.push_back(detail::pixel_chart(data, data.blocks[b], slugs[b], features));
  }
  return charts;
}

}  // namespace kinecal
