// Drawing residuals in images.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/pixels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kinecal/report/charts/arrows.hpp"
#include "kinecal/report/charts/image_place.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

void draw_arrows(Drawing& drawing, const ReportData& data,
                 const std::vector<const ReportedFeature*>& features,
                 const std::vector<std::size_t>& chosen, const ImageScale& scale) {
  for (const bool bad : {false, true}) {
    drawing.open_group(bad ? "arrows bad" : "arrows");
    for (const std::size_t i : chosen) {
      const ReportedFeature& feature = *features[i];
      if (sample_of(data, feature).bad != bad) continue;
      const auto [x, y] = *feature.pixel;
      std::string path;
      append_arrow(path, scale.at(x, y), scale.end_of(feature));
      drawing.path(path, "", sample_number(data, feature));
    }
    drawing.close_group();
  }
}

/// Mean residuals in cells of the image; arrows of single features would hide the pattern.
/// @returns  true if there are any
bool draw_mean_arrows(Drawing& drawing, const std::vector<const ReportedFeature*>& features,
                      const ReportData& data, const ImageFrame& frame, const ImageScale& scale) {
  constexpr std::size_t kFewest = 100, kInCell = 5;
  constexpr int kColumns = 8, kRows = 6;
  if (features.size() < kFewest) return false;
  struct Cell {
    std::vector<double> u, v;
  };
  std::array<Cell, static_cast<std::size_t>(kColumns * kRows)> cells;
  const auto part = [&](const ReportedFeature& feature, std::size_t i, int parts) {
    const double share = ((*feature.pixel)[i] - frame.low[i]) / (frame.high[i] - frame.low[i]);
    return std::clamp(static_cast<int>(share * parts), 0, parts - 1);
  };
  for (const ReportedFeature* feature : features) {
    if (sample_of(data, *feature).bad) continue;
    const int index = part(*feature, 1, kRows) * kColumns + part(*feature, 0, kColumns);
    Cell& cell = cells[static_cast<std::size_t>(index)];
    cell.u.push_back(feature->residual[0]);
    cell.v.push_back(feature->residual[1]);
  }
  std::string path;
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Cell& cell = cells[static_cast<std::size_t>(i)];
    if (cell.u.size() < kInCell) continue;
    const int row = i / kColumns, column = i % kColumns;
    const double x = std::lerp(frame.low[0], frame.high[0], (column + 0.5) / kColumns);
    const double y = std::lerp(frame.low[1], frame.high[1], (row + 0.5) / kRows);
    const double u = quantile(sorted_finite(cell.u), 0.5), v = quantile(sorted_finite(cell.v), 0.5);
    append_arrow(path, scale.at(x, y), scale.at(x + scale.times * u, y + scale.times * v));
  }
  if (!path.empty()) drawing.path(path, "median");
  return !path.empty();
}

/// An arrow of a round length in pixels, with the meaning of arrows.
void draw_arrow_key(Drawing& drawing, const ImageScale& scale, bool has_means) {
  constexpr double kLongest = 50.0, kTop = 12.0;
  const double longest = kLongest / (scale.pixel * scale.times);
  double length = round_step(longest, 1);
  if (length > longest) length = round_step(0.5 * longest, 1);
  const double end = 8.0 + length * scale.pixel * scale.times;
  std::string path;
  append_arrow(path, {8.0, kTop}, {end, kTop});
  drawing.open_group("arrows");
  drawing.path(path, "");
  drawing.close_group();
  drawing.text(
      {end + 8.0, kTop + 4.0},
      fmt::format("{} px: {} times as long as in the image", figure(length), figure(scale.times)),
      "small");
  if (!has_means) return;
  path.clear();
  append_arrow(path, {8.0, kTop + 19.0}, {32.0, kTop + 19.0});
  drawing.path(path, "median");
  drawing.text({40.0, kTop + 23.0}, "median of a region", "small");
}

[[nodiscard]] Chart pixel_chart(const ReportData& data, const ReportedBlock& block,
                                const std::string& slug,
                                const std::vector<const ReportedFeature*>& features) {
  constexpr std::size_t kMostArrows = 1000;
  std::vector<double> sizes;
  for (const ReportedFeature* f : features)
    sizes.push_back(std::hypot(f->residual[0], f->residual[1]));
  const std::vector<double> sorted = sorted_finite(sizes);
  const std::vector<std::size_t> chosen = chosen_marks(sizes, kMostArrows);
  Chart chart{"pixels", "pixels-" + slug, "Residuals in the image: " + shortened(block.name, 60),
              "From observed to predicted. Arrows that point the same way in a region show a lens "
              "error; red: samples that do not fit." +
                  chosen_text(chosen.size(), features.size(), "features"),
              ""};
  const ImageFrame frame = image_frame(block, features);
  const double width = frame.high[0] - frame.low[0], height = frame.high[1] - frame.low[1];
  constexpr double kMargin = 12.0, kTop = 52.0, kMostHeight = 420.0;
  ImageScale scale{{kMargin, kTop}, frame.low, frame.high};
  scale.pixel = std::min((kChartWidth - 2.0 * kMargin) / width, kMostHeight / height);
  scale.times = arrow_times(sorted, scale.pixel);
  scale.corner[0] = 0.5 * (kChartWidth - scale.pixel * width);
  const double bottom = kTop + scale.pixel * height;
  Drawing drawing(chart.name, chart.title, bottom + 24.0);
  drawing.rectangle(scale.corner, scale.pixel * width, scale.pixel * height, "frame");
  draw_arrows(drawing, data, features, chosen, scale);
  draw_arrow_key(drawing, scale, draw_mean_arrows(drawing, features, data, frame, scale));
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

}  // namespace
}  // namespace detail

std::vector<Chart> pixel_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    const auto features = detail::features_in_image(data, block);
    return features.empty() ? Chart() : detail::pixel_chart(data, block, slug, features);
  });
}

}  // namespace kinecal
