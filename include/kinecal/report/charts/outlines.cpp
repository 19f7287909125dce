// Drawing outlines over masks.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/outlines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include "kinecal/report/charts/image_place.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

using Pixel = std::optional<std::array<double, 2>>;

/// What the fit uses of a mask.
struct MaskOfSample {
  std::vector<const ReportedFeature*> features;
  double before = 0.0, after = 0.0;  ///< median distances, pixels

  void set_medians() {
    std::vector<double> all_before, all_after;
    for (const ReportedFeature* feature : features) {
      all_before.push_back(feature->before);
      all_after.push_back(feature->after);
    }
    before = quantile(sorted_finite(all_before), 0.5);
    after = quantile(sorted_finite(all_after), 0.5);
  }
  [[nodiscard]] bool has_before() const {
    return std::any_of(features.begin(), features.end(),
                       [](const ReportedFeature* of) { return of->outline_before.has_value(); });
  }
};

/// The masks of a block whose samples the fit uses, best first.
[[nodiscard]] std::vector<MaskOfSample> masks_of(const ReportData& data,
                                                 const ReportedBlock& block) {
  std::map<int, MaskOfSample> by_sample;
  for (const ReportedFeature& feature : block.features) {
    const bool is_shown = feature.pixel && feature.outline_after && std::isfinite(feature.after);
    if (!is_shown || sample_of(data, feature).left_out) continue;
    by_sample[feature.sample].features.push_back(&feature);
  }
  std::vector<MaskOfSample> masks;
  for (auto& [sample, mask] : by_sample) {
    mask.set_medians();
    masks.push_back(std::move(mask));
  }
  std::stable_sort(masks.begin(), masks.end(),
                   [](const MaskOfSample& a, const MaskOfSample& b) { return a.after < b.after; });
  return masks;
}

/// The frame of an image on the chart.
struct ImageOnChart {
  ImageFrame frame;
  ChartPoint corner = {};
  double scale = 1.0;  ///< of a pixel

  [[nodiscard]] bool contains(const std::array<double, 2>& pixel) const {
    return pixel[0] >= frame.low[0] && pixel[0] <= frame.high[0] && pixel[1] >= frame.low[1] &&
           pixel[1] <= frame.high[1];
  }
  [[nodiscard]] ChartPoint at(const std::array<double, 2>& pixel) const {
    return {corner[0] + scale * (pixel[0] - frame.low[0]),
            corner[1] + scale * (pixel[1] - frame.low[1])};
  }
};

/// Draws pixels of a mask that are in the image, evenly thinned.
void draw_dots(Drawing& drawing, const ReportData& data, const MaskOfSample& mask,
               const ImageOnChart& image, Pixel ReportedFeature::*pixel, const char* classes) {
  constexpr std::size_t kMost = 900;
  std::vector<const Pixel*> seen;
  for (const ReportedFeature* feature : mask.features) {
    const Pixel& of = feature->*pixel;
    if (of && image.contains(*of)) seen.push_back(&of);
  }
  std::string path;
  const std::size_t kept = std::min(seen.size(), kMost);
  for (std::size_t i = 0; i < kept; ++i) {
    append_dot(path, image.at(**seen[i * seen.size() / kept]));
  }
  if (path.empty()) return;
  drawing.open_group(classes);
  drawing.path(path, "", sample_number(data, *mask.features.front()));
  drawing.close_group();
}

/// @param which  "worst", "median"
[[nodiscard]] Chart outline_chart(const ReportData& data, const ReportedBlock& block,
                                  const std::string& slug, const MaskOfSample& mask,
                                  const char* which) {
  const bool has_before = mask.has_before();
  const int number = sample_number(data, *mask.features.front());
  Chart chart{
      "pixels", fmt::format("outline-{}-{}", slug, which),
      fmt::format("Outline over the mask: {}, {} sample", shortened(block.name, 60), which),
      "Points of the robot's outline where the camera should see them, over the edges of the mask "
      "that the fit uses; where blue lies within the grey band, the robot is where the mask shows "
      "it.",
      ""};
  constexpr double kMargin = 12.0, kMostHeight = 420.0, kTop = 8.0;
  std::vector<LegendEntry> legend = {{Swatch::square, "faint", "edge of the mask"},
                                     {Swatch::square, "after", "outline after"}};
  if (has_before) legend.insert(legend.begin() + 1, {Swatch::square, "before", "outline before"});
  ImageOnChart image{.frame = image_frame(block, mask.features)};
  const double width = image.frame.high[0] - image.frame.low[0],
               height = image.frame.high[1] - image.frame.low[1];
  image.scale = std::min((kChartWidth - 2.0 * kMargin) / width, kMostHeight / height);
  constexpr double kLegend = 26.0;
  image.corner = {0.5 * (kChartWidth - image.scale * width), kTop + kLegend};
  const double bottom = image.corner[1] + image.scale * height;
  Drawing drawing(chart.name, chart.title, bottom + 24.0);
  draw_legend(drawing, legend, kTop - 4.0);
  drawing.rectangle(image.corner, image.scale * width, image.scale * height, "frame");
  draw_dots(drawing, data, mask, image, &ReportedFeature::pixel, "dots mask");
  draw_dots(drawing, data, mask, image, &ReportedFeature::outline_before, "dots outline before");
  draw_dots(drawing, data, mask, image, &ReportedFeature::outline_after, "dots outline");
  const std::string medians = (has_before ? with_unit(mask.before, block.unit) + " → " : "") +
                              with_unit(mask.after, block.unit);
  drawing.text({image.corner[0], bottom + 17.0},
               fmt::format("sample {}: median distance {}", number, medians), "small quiet");
  chart.svg = drawing.str(fmt::format(
      "Sample {}: {} pairs of a mask's edge and a point of the outline, {}median distance {}.",
      number, count_text(mask.features.size()), has_before ? "before and after, " : "", medians));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> outline_charts(const ReportData& data) {
  std::vector<Chart> charts;
  detail::for_each_block(data, [&](const ReportedBlock& block, const std::string& slug) {
    const std::vector<detail::MaskOfSample> masks = detail::masks_of(data, block);
    if (masks.empty()) return;
    charts.push_back(detail::outline_chart(data, block, slug, masks.back(), "worst"));
    if (masks.size() < 3) return;
    const auto& median = masks[(masks.size() - 1) / 2];
    charts.push_back(detail::outline_chart(data, block, slug, median, "median"));
  });
  return charts;
}

}  // namespace kinecal
