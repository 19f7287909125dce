// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/outlines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

/// An edge of a mask, and the outline beside it.
ReportedFeature edge(int sample, double u, double v, double before, double after) {
  ReportedFeature feature;
  feature.sample = sample;
  feature.pixel = {{u, v}};
  feature.outline_before = {{u - before, v}};
  feature.outline_after = {{u, v + after}};
  feature.before = before;
  feature.after = after;
  feature.residual = {after};
  return feature;
}

/// Five samples of three edges; sample 4 is worst, sample 1 best.
ReportData with_masks() {
  ReportData data;
  ReportedBlock block{"outline", "camera2d_to_mesh", "px"};
  block.image = {640.0, 480.0};
  int number = 0;
  for (const double after : {1.0, 2.0, 3.0, 9.0, 4.0}) {
    for (const double v : {100.0, 200.0, 300.0}) {
      block.features.push_back(edge(number, 200.0 + 10.0 * number, v, 40.0, after));
    }
    data.samples.push_back({++number, "", false, false, "", 0.0});
  }
  data.blocks = {block};
  return data;
}

/// The places of a group's dots, in pixels of the image.
std::vector<std::array<double, 2>> dots(const test::SvgChart& chart, const std::string& classes) {
  const pugi::xml_node frame = chart.all("//rect[@class='frame']").at(0);
  const double scale = frame.attribute("width").as_double() / 640.0;
  EXPECT_NEAR(frame.attribute("height").as_double(), 480.0 * scale, 0.1);
  std::vector<std::array<double, 2>> all;
  for (const pugi::xml_node& path : chart.all(("//g[@class='" + classes + "']/path").c_str())) {
    const std::vector<double> numbers = test::numbers_of(path);  // x y 0 of each
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
      all.push_back({(numbers[i] - frame.attribute("x").as_double()) / scale,
                     (numbers[i + 1] - frame.attribute("y").as_double()) / scale});
    }
  }
  return all;
}

constexpr double kTenth = 0.2;  ///< pixels: coordinates have one decimal

TEST(OutlineCharts, MaskAndOutlinesAreAtTheirPixels) {
  const std::vector<Chart> charts = outline_charts(with_masks());
  ASSERT_THAT(charts, SizeIs(2));
  const test::SvgChart worst(charts[0]);
  const auto mask = dots(worst, "dots mask"), before = dots(worst, "dots outline before"),
             after = dots(worst, "dots outline");
  ASSERT_THAT(mask, SizeIs(3));
  ASSERT_THAT(before, SizeIs(3));
  ASSERT_THAT(after, SizeIs(3));
  for (std::size_t i = 0; i < 3; ++i) {
    const double v = 100.0 * (static_cast<double>(i) + 1.0);
    EXPECT_NEAR(mask[i][0], 230.0, kTenth);
    EXPECT_NEAR(mask[i][1], v, kTenth) << "v points down";
    EXPECT_NEAR(before[i][0], 190.0, kTenth);
    EXPECT_NEAR(before[i][1], v, kTenth);
    EXPECT_NEAR(after[i][0], 230.0, kTenth);
    EXPECT_NEAR(after[i][1], v + 9.0, kTenth);
  }
}

TEST(OutlineCharts, ShowTheWorstSampleAndTheMedianOne) {
  ReportData data = with_masks();
  std::vector<Chart> charts = outline_charts(data);
  ASSERT_THAT(charts, SizeIs(2));
  EXPECT_EQ(charts[0].name, "outline-outline-worst");
  EXPECT_THAT(test::SvgChart(charts[0]).text("//text[@class='small quiet']"),
              HasSubstr("sample 4: median distance 40 px → 9 px"));
  EXPECT_EQ(charts[1].name, "outline-outline-median");
  EXPECT_THAT(charts[1].svg, HasSubstr("data-sample=\"3\""));
  data.samples[3].left_out = true;
  charts = outline_charts(data);
  EXPECT_THAT(charts.at(0).svg, HasSubstr("data-sample=\"5\"")) << "the fit does not use sample 4";
  data.blocks[0].features.resize(3);
  EXPECT_THAT(outline_charts(data), SizeIs(1)) << "of one sample";
}

TEST(OutlineCharts, AnUnknownPoseHasNoBefore) {
  ReportData data = with_masks();
  for (ReportedFeature& feature : data.blocks[0].features) feature.outline_before.reset();
  const Chart chart = outline_charts(data).at(0);
  EXPECT_THAT(chart.svg, Not(HasSubstr("before")));
  EXPECT_THAT(dots(test::SvgChart(chart), "dots outline"), SizeIs(3));
}

TEST(OutlineCharts, WhatIsOutsideOfTheImageIsNotDrawn) {
  ReportData data = with_masks();
  for (ReportedFeature& feature : data.blocks[0].features) feature.outline_before = {{-5.0, 9e9}};
  const test::SvgChart chart(outline_charts(data).at(0));
  EXPECT_THAT(dots(chart, "dots outline before"), IsEmpty());
  EXPECT_THAT(dots(chart, "dots outline"), SizeIs(3));
}

TEST(OutlineCharts, AreThinnedEvenly) {
  ReportData data = with_masks();
  data.blocks[0].features.clear();
  for (int i = 0; i < 9000; ++i) {
    data.blocks[0].features.push_back(edge(0, 20.0 + 0.06 * i, 50.0, 3.0, 1.0));
  }
  const Chart chart = outline_charts(data).at(0);
  const auto after = dots(test::SvgChart(chart), "dots outline");
  EXPECT_THAT(after, SizeIs(900));
  EXPECT_NEAR(after.back()[0], 20.0 + 0.06 * 8990, kTenth);
  EXPECT_LT(chart.svg.size(), 45'000u);
}

TEST(OutlineCharts, OtherBlocksHaveNone) {
  EXPECT_THAT(outline_charts(test::report_data()), IsEmpty());
}

}  // namespace
}  // namespace kinecal
