// Drawing residuals of features.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "kinecal/report/charts/distance_axis.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

/// All residuals of a feature.
struct FeatureBox {
  std::string label;           ///< its number, from 1, or its id
  std::vector<double> sorted;  ///< distances
  std::vector<std::size_t> features;
};

constexpr std::size_t kMostBoxes = 48;

/// By place or id, those with the largest medians if there are too many.
/// @param all  out: their total number
[[nodiscard]] std::vector<FeatureBox> feature_boxes(const ReportedBlock& block,
                                                    const std::vector<double>& distances,
                                                    std::size_t& all) {
  std::map<std::pair<bool, int>, FeatureBox> by_label;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    if (!std::isfinite(distances[i])) continue;
    const FeatureLabel& label = block.features[i].feature;
    const int number = label.id ? *label.id : label.place + 1;
    FeatureBox& box = by_label[{label.id.has_value(), number}];
    box.label = std::to_string(number);
    box.sorted.push_back(distances[i]);
    box.features.push_back(i);
  }
  all = by_label.size();
  std::vector<std::pair<double, std::pair<bool, int>>> order;
  for (auto& [label, box] : by_label) {
    std::sort(box.sorted.begin(), box.sorted.end());
    order.push_back({-quantile(box.sorted, 0.5), label});
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = kMostBoxes; i < order.size(); ++i) by_label.erase(order[i].second);
  std::vector<FeatureBox> boxes;
  for (auto& [label, box] : by_label) boxes.push_back(std::move(box));
  return boxes;
}

void draw_box(Drawing& drawing, const FeatureBox& box, double at, double width, const Axis& y) {
  const double low = y.at(quantile(box.sorted, 0.25)), high = y.at(quantile(box.sorted, 0.75));
  const double median = y.at(quantile(box.sorted, 0.5)), half = 0.5 * width;
  drawing.area(
      std::vector<ChartPoint>{
          {at - half, low}, {at + half, low}, {at + half, high}, {at - half, high}},
      "area after");
  drawing.path(
      fmt::format("M{} {}h{}", coordinate(at - half), coordinate(median), coordinate(width)),
      "after thick", 0,
      fmt::format("feature {}: median {}, {} times", box.label, figure(quantile(box.sorted, 0.5)),
                  box.sorted.size()));
}

/// Dots of a box, spread over its width in recording order.
void draw_strip(Drawing& drawing, const ReportData& data, const ReportedBlock& block,
                const FeatureBox& box, const std::vector<double>& distances, double at,
                double width, const Axis& y, std::size_t most) {
  std::vector<double> own;
  for (const std::size_t i : box.features) own.push_back(distances[i]);
  for (const std::size_t i : chosen_marks(own, most)) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(own.size()) - 0.5;
    std::string dot;
    append_dot(dot, {at + share * width, y.at(own[i])});
    drawing.path(dot, "", sample_number(data, block.features[box.features[i]]));
  }
}

[[nodiscard]] std::string boxes_description(const ReportedBlock& block,
                                            const std::vector<FeatureBox>& boxes) {
  const auto median = [](const FeatureBox& box) { return quantile(box.sorted, 0.5); };
  const auto [best, worst] = std::minmax_element(
      boxes.begin(), boxes.end(),
      [&](const FeatureBox& a, const FeatureBox& b) { return median(a) < median(b); });
  return fmt::format(
      "Distances by feature. The median is largest for feature {}, {} {}, and "
      "smallest for feature {}, {} {}.",
      worst->label, figure(median(*worst)), people_unit(block.unit), best->label,
      figure(median(*best)), people_unit(block.unit));
}

[[nodiscard]] Chart feature_chart(const ReportData& data, const ReportedBlock& block,
                                  const std::string& slug, const std::vector<double>& distances,
                                  const std::vector<FeatureBox>& boxes, std::size_t all) {
  Chart chart{"residuals", "features-" + slug,
              "Residuals of each feature: " + shortened(block.name, 60),
              "Boxes hold the middle half, with the median; dots are samples.", ""};
  if (boxes.size() < all) {
    chart.caption += fmt::format(" Of {} features, the {} with the largest medians are shown.",
                                 count_text(all), boxes.size());
  }
  const PlotArea area{46.0, 46.0, kChartWidth - 10.0, 260.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  const Axis y = distance_axis(block, sorted_finite(distances), area.bottom, area.top);
  draw_legend(drawing, noise_entries(y, block), 0.0);
  drawing.axis_y(area, y, axis_name("distance", block.unit));
  draw_noise_lines(drawing, area, y, block);
  const double step = (area.right - area.left) / static_cast<double>(boxes.size());
  const double width = std::min(44.0, 0.7 * step);
  const std::size_t every = 1 + static_cast<std::size_t>(26.0 / step);  // labels that fit
  std::size_t shown = 0, drawn = 0;
  for (const FeatureBox& box : boxes) {
    const double at = area.left + step * (static_cast<double>(shown) + 0.5);
    draw_box(drawing, box, at, width, y);
    drawing.open_group("dots small");
    const std::size_t most = kMostMarks / 2 / boxes.size();
    draw_strip(drawing, data, block, box, distances, at, 0.8 * width, y, most);
    drawing.close_group();
    if (shown++ % every == 0) {
      drawing.text({at, area.bottom + 16.0}, box.label, "tick", Anchor::middle);
    }
    drawn += std::min(most, box.sorted.size());
  }
  drawing.line({area.left, area.bottom}, {area.right, area.bottom}, "axis");
  drawing.text({area.right, area.bottom + 33.0},
               block.features[boxes[0].features[0]].feature.id ? "id of the feature" : "feature",
               "name", Anchor::end);
  chart.caption += chosen_text(drawn, sorted_finite(distances).size(), "dots");
  chart.svg = drawing.str(boxes_description(block, boxes));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> feature_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    const std::vector<double> distances = detail::used_distances(data, block);
    std::size_t all = 0;
    const auto boxes = detail::feature_boxes(block, distances, all);
    return all < 2 ? Chart() : detail::feature_chart(data, block, slug, distances, boxes, all);
  });
}

}  // namespace kinecal
