// Drawing residuals of samples.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/report/charts/distance_axis.hpp"
#include "kinecal/report/charts/sample_marks.ipp"
#include "kinecal/report/svg.hpp"
#include "kinecal/report/svg_legend.hpp"
#include "kinecal/report/svg_text.hpp"

namespace kinecal {

namespace detail {
namespace {

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
