// Drawing residuals of samples.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/samples.hpp"

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
    append_dot(dots[number], {x.at(number), y.at(distances[i])});
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
  std::vector<Place> taken;
  for (const auto& [number, worst] : order) {
    const Place place = {x.at(number), y.at(worst.distance)};
    constexpr double kWide = 40.0, kHigh = 13.0;
    if (std::none_of(taken.begin(), taken.end(), [&](const Place& other) {
          return std::abs(other[0] - place[0]) < kWide && std::abs(other[1] - place[1]) < kHigh;
        })) {
      const bool at_right = place[0] > x.to() - kWide;
      drawing.text({place[0] + (at_right ? -7.0 : 7.0), place[1] + 4.0}, std::to_string(number),
                   "small", at_right ? Anchor::end : Anchor::start);
    }
    taken.push_back(place);
  }
}

/// Crosses at the top for samples left out that have no feature in the block.
void draw_left_out(Drawing& drawing, const ReportData& data, const SampleMarks& marks,
                   const Axis& x, double top) {
  Dots crosses;
  for (const ReportedSample& sample : data.samples) {
    const bool drawn = marks.worst_of.count(sample.number) > 0;
    if (!sample.left_out || drawn || sample.number <= 0 || crosses.size() >= kMostMarks) continue;
    const double at = x.at(sample.number);
    crosses[sample.number] =
        fmt::format("M{0} {2}L{1} {3}M{1} {2}L{0} {3}", coordinate(at - 3.5), coordinate(at + 3.5),
                    coordinate(top + 3.0), coordinate(top + 10.0));
  }
  for (const auto& [number, path] : crosses) {
    drawing.path(path, "faint thick", number, fmt::format("sample {}: left out", number));
  }
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
                                                      const ReportedBlock& block) {
  std::vector<LegendEntry> legend = {{Swatch::dot, "after", "worst of a sample"}};
  const auto any = [&](bool ReportedSample::*flag) {
    return std::any_of(data.samples.begin(), data.samples.end(),
                       [&](const ReportedSample& sample) { return sample.*flag; });
  };
  if (any(&ReportedSample::bad)) legend.push_back({Swatch::dot, "bad", "does not fit"});
  if (any(&ReportedSample::left_out)) legend.push_back({Swatch::dot, "faint", "left out"});
  if (block.sigma > 0.0) legend.push_back({Swatch::line, "sigma", "noise"});
  return legend;
}

/// The meaning of the lines drawn by draw_noise_lines().
[[nodiscard]] std::string noise_lines_text(const std::vector<double>& times) {
  if (times.empty()) return "";
  if (times.size() > 1) return " Lines: what noise makes one expect, and three times that.";
  return times.front() == 1.0 ? " Line: what noise makes one expect."
                              : " Line: three times what noise makes one expect.";
}

[[nodiscard]] Chart sample_chart(const ReportData& data, const ReportedBlock& block,
                                 const std::string& slug) {
  const std::vector<double> distances = distances_of(block), sorted = sorted_finite(distances);
  const auto chosen = chosen_marks(distances);
  Chart chart{"residuals", "samples-" + slug,
              "Residuals in capture order: " + shortened(block.name, 60),
              "Each dot is a feature, the dark ones are the worst of their samples.", ""};
  const PlotArea area{46.0, 46.0, kChartWidth - 20.0, 270.0};
  Drawing drawing(chart.name, chart.title, area.bottom + 38.0);
  draw_legend(drawing, samples_legend(data, block), 0.0);
  const Axis x = samples_axis(data, block, area);
  const Axis y = distance_axis(block, sorted, area.bottom, area.top + 14.0);
  drawing.axis_y(area, y, axis_name("distance", block.unit));
  drawing.axis_x(area, x, "sample", true);
  chart.caption += noise_lines_text(draw_noise_lines(drawing, area, y, block)) +
                   chosen_text(chosen.size(), sorted.size(), "features");
  const SampleMarks marks = sample_marks(data, block, distances, chosen, x, y);
  draw_dots(drawing, data, block, marks, marks.others, "dots");
  draw_dots(drawing, data, block, marks, marks.left_out, "dots out");
  draw_dots(drawing, data, block, marks, marks.worst, "dots worst");
  draw_dots(drawing, data, block, marks, marks.bad, "dots bad");
  draw_left_out(drawing, data, marks, x, area.top);
  number_worst(drawing, marks, x, y);
  chart.svg = drawing.str(samples_description(data, block, distances, sorted));
  return chart;
}

}  // namespace
}  // namespace detail

std::vector<Chart> sample_charts(const ReportData& data) {
  std::vector<Chart> charts;
  const std::vector<std::string> slugs = detail::block_slugs(data);
  for (std::size_t b = 0; b < data.blocks.size(); ++b) {
    const auto& features = data.blocks[b].features;
    if (std::any_of(features.begin(), features.end(),
                    [](const ReportedFeature& f) { return std::isfinite(f.after); })) {
      charts.push_back(detail::sample_chart(data, data.blocks[b], slugs[b]));
    }
  }
  return charts;
}

}  // namespace kinecal
