// Drawing residuals of samples.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/report/charts/chart.hpp"
#include "kinecal/report/charts/distance_axis.hpp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

// The marks of samples in the chart of their residuals.

/// The drawn mark of a sample's worst feature.
struct WorstMark {
  std::size_t feature = 0;  ///< index into the block's
  double distance = 0.0;
};

/// Paths of dots, one for each sample, by its number.
using Dots = std::map<int, std::string>;

/// The marks of a block's samples; each list of dots is one group of the svg.
struct SampleMarks {
  Dots others, worst, bad, left_out;
  std::map<int, WorstMark> worst_of;  ///< by number
};

[[nodiscard]] SampleMarks sample_marks(const ReportData& data, const ReportedBlock& block,
                                       const std::vector<double>& distances,
                                       const std::vector<std::size_t>& chosen, const Axis& x,
                                       const Axis& y) {
  SampleMarks marks;
  for (const std::size_t i : chosen) {
    const int number = sample_number(data, block.features[i]);
    WorstMark& worst = marks.worst_of.try_emplace(number, WorstMark{i, distances[i]}).first->second;
    if (distances[i] > worst.distance) worst = {i, distances[i]};
  }
  constexpr std::size_t kFew = 400;  // with more samples, most dots would be dark
  const double dark =
      marks.worst_of.size() <= kFew ? 0.0 : quantile(sorted_finite(distances), 0.998);
  for (const std::size_t i : chosen) {
    const int number = sample_number(data, block.features[i]);
    const ReportedSample& sample = sample_of(data, block.features[i]);
    const bool is_worst = marks.worst_of[number].feature == i;
    Dots& dots = sample.left_out       ? marks.left_out
                 : !is_worst           ? marks.others
                 : sample.bad          ? marks.bad
                 : distances[i] < dark ? marks.others
                                       : marks.worst;
    const ChartPoint place = {x.at(number), y.at(distances[i])};
    sample.left_out ? append_cross(dots[number], place) : append_dot(dots[number], place);
  }
  return marks;
}

void draw_dots(Drawing& drawing, const ReportData& data, const ReportedBlock& block,
               const SampleMarks& marks, const Dots& dots, const char* classes) {
  if (dots.empty()) return;
  drawing.open_group(classes);
  for (const auto& [number, path] : dots) {
    const std::size_t worst = marks.worst_of.at(number).feature;
    const bool titled = &dots != &marks.others;  // otherwise the worst one has the title
    drawing.path(path, "", number,
                 titled ? feature_text(data, block, block.features[worst]) : std::string());
  }
  drawing.close_group();
}

/// Numbers beside the three worst samples, unless one would cover another.
void number_worst(Drawing& drawing, const SampleMarks& marks, const Axis& x, const Axis& y) {
  std::vector<std::pair<int, WorstMark>> order(marks.worst_of.begin(), marks.worst_of.end());
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) {
    return a.second.distance > b.second.distance;
  });
  order.resize(std::min<std::size_t>(order.size(), 3));
  std::vector<ChartPoint> taken;
  for (const auto& [number, worst] : order) {
    const ChartPoint place = {x.at(number), y.at(worst.distance)};
    constexpr double kWide = 40.0, kHigh = 13.0;
    if (std::none_of(taken.begin(), taken.end(), [&](const ChartPoint& other) {
          return std::abs(other[0] - place[0]) < kWide && std::abs(other[1] - place[1]) < kHigh;
        })) {
      const bool at_right = place[0] > x.to() - kWide;
      drawing.text({place[0] + (at_right ? -7.0 : 7.0), place[1] + 4.0}, std::to_string(number),
                   "small", at_right ? Anchor::end : Anchor::start);
    }
    taken.push_back(place);
  }
}

/// Crosses of samples that were left out; at the top if they have no feature in the block.
void draw_left_out(Drawing& drawing, const ReportData& data, const ReportedBlock& block,
                   const SampleMarks& marks, const Axis& x, const Axis& y, double top) {
  Dots crosses = marks.left_out;
  std::map<int, std::pair<ChartPoint, std::string>> targets;
  for (const ReportedSample& sample : data.samples) {
    const int number = sample.number;
    if (!sample.left_out || number <= 0 || targets.size() >= kMostMarks) continue;
    const auto worst = marks.worst_of.find(number);
    if (worst == marks.worst_of.end()) {
      const ChartPoint place = {x.at(number), top + 6.5};
      targets[number] = {place, fmt::format("sample {}: left out", number)};
      append_cross(crosses[number], place);
    } else {
      targets[number] = {
          {x.at(number), y.at(worst->second.distance)},
          feature_text(data, block, block.features[worst->second.feature]) + ", left out"};
    }
  }
  if (crosses.empty()) return;
  drawing.open_group("out");
  for (const auto& [number, path] : crosses) drawing.path(path, "", number);
  constexpr double kTarget = 8.0;  // a cross is hard to hit
  for (const auto& [number, target] : targets) {
    drawing.circle(target.first, kTarget, "target", number, target.second);
  }
  drawing.close_group();
}

[[nodiscard]] std::string samples_description(const ReportData& data, const ReportedBlock& block,
                                              const std::vector<double>& distances,
                                              const std::vector<double>& sorted) {
  const auto worst = std::max_element(distances.begin(), distances.end(), [](double a, double b) {
    return (std::isfinite(a) ? a : -1.0) < (std::isfinite(b) ? b : -1.0);
  });
  const auto& feature = block.features[static_cast<std::size_t>(worst - distances.begin())];
  return fmt::format("Distances of {} features in capture order. Median {} {}; the worst is {}.",
                     count_text(sorted.size()), figure(quantile(sorted, 0.5)),
                     people_unit(block.unit), feature_text(data, block, feature));
}

[[nodiscard]] std::vector<LegendEntry> samples_legend(const ReportData& data,
                                                      const ReportedBlock& block, const Axis& y) {
  std::vector<LegendEntry> legend = {{Swatch::dot, "after", "worst of a sample"}};
  const auto any = [&](auto is) {
    return std::any_of(data.samples.begin(), data.samples.end(), is);
  };
  if (any([](const ReportedSample& sample) { return sample.bad && !sample.left_out; })) {
    legend.push_back({Swatch::dot, "bad", "does not fit"});
  }
  if (any([](const ReportedSample& sample) { return sample.left_out; })) {
    legend.push_back({Swatch::cross, "out", "left out"});
  }
  for (LegendEntry& entry : noise_entries(y, block)) legend.push_back(std::move(entry));
  return legend;
}

/// What the marks mean that no legend has.
[[nodiscard]] std::string samples_caption(const ReportData& data, std::size_t drawn,
                                          std::size_t all) {
  std::string text = "Each dot is a feature, the large ones are the worst of their samples.";
  if (std::any_of(data.samples.begin(), data.samples.end(),
                  [](const ReportedSample& sample) { return sample.left_out; })) {
    text += " Crosses at the upper edge are farther off, or have no feature in this block.";
  }
  return text + chosen_text(drawn, all, "features");
}

[[nodiscard]] Chart sample_chart(const ReportData& data, const ReportedBlock& block,
                                 const std::string& slug) {
  const std::vector<double> distances = distances_of(block), used = used_distances(data, block),
                            sorted = sorted_finite(used);
  const auto chosen = chosen_marks(distances);
  Chart chart{"residuals", "samples-" + slug,
              "Residuals in capture order: " + shortened(block.name, 60),
              samples_caption(data, chosen.size(), sorted_finite(distances).size()), ""};
  const std::vector<LegendEntry> legend =
      samples_legend(data, block, distance_axis(block, sorted, 1.0, 0.0));
  Drawing measured("", "", 0.0);  // to measure the height of the legend
  const double top = draw_legend(measured, legend, 0.0) + 28.0;
  const PlotArea area{46.0, top, kChartWidth - 20.0, top + 224.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  const Axis x = samples_axis(data, block, area);
  const Axis y = distance_axis(block, sorted, area.bottom, area.top + 14.0);
  draw_legend(drawing, legend, 0.0);
  drawing.axis_y(area, y, axis_name("distance", block.unit));
  drawing.axis_x(area, x, "sample", true);
  draw_noise_lines(drawing, area, y, block);
  const SampleMarks marks = sample_marks(data, block, distances, chosen, x, y);
  draw_dots(drawing, data, block, marks, marks.others, "dots");
  draw_dots(drawing, data, block, marks, marks.worst, "dots worst");
  draw_dots(drawing, data, block, marks, marks.bad, "dots bad");
  draw_left_out(drawing, data, block, marks, x, y, area.top);
  number_worst(drawing, marks, x, y);
  chart.svg = drawing.str(samples_description(data, block, used, sorted));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> sample_charts(const ReportData& data) {
  return detail::charts_of_blocks(data, [&](const ReportedBlock& block, const std::string& slug) {
    const bool any = std::any_of(block.features.begin(), block.features.end(),
                                 [](const ReportedFeature& f) { return std::isfinite(f.after); });
    return any ? detail::sample_chart(data, block, slug) : Chart();
  });
}

}  // namespace kinecal
