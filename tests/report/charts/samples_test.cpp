// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/samples.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "kinecal/report/charts/depth.hpp"
#include "kinecal/report/charts/features.hpp"
#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

TEST(SampleCharts, DotsStandAtTheirSampleAndDistance) {
  ReportData data = test::report_data(12);
  const ReportedBlock& block = data.blocks[2];  // its axis is linear
  const Chart chart = test::chart_named(sample_charts(data), "samples-ground");
  const test::SvgChart svg(chart);
  std::multimap<int, double> drawn;
  for (const pugi::xml_node& path : svg.all("//g/path")) {
    const int sample = path.attribute("data-sample").as_int();
    const std::vector<double> numbers = test::numbers_of(path);
    for (std::size_t i = 0; i < numbers.size(); i += 3) {  // "M x y h 0"
      EXPECT_NEAR(svg.value('x', numbers[i]), sample, 0.02);
      drawn.emplace(sample, svg.value('y', numbers[i + 1]));
    }
  }
  ASSERT_EQ(drawn.size(), block.features.size());
  for (const ReportedFeature& feature : block.features) {
    const auto [begin, end] = drawn.equal_range(feature.sample + 1);
    constexpr double kDrawn = 0.03;  // mm: a tenth of a unit of the chart
    EXPECT_TRUE(std::any_of(begin, end, [&](const auto& mark) {
      return std::abs(mark.second - 1e3 * feature.after) < kDrawn;
    })) << feature.sample;
  }
}

TEST(SampleCharts, MarkBadSamplesAndThoseLeftOut) {
  const ReportData data = test::report_data();
  const test::SvgChart chart(test::chart_named(sample_charts(data), "samples-hand_eye"));
  const auto bad = chart.all("//g[@class='dots bad']/path");
  ASSERT_EQ(bad.size(), 2u);
  EXPECT_EQ(bad[0].attribute("data-sample").as_int(), 18);
  EXPECT_EQ(bad[1].attribute("data-sample").as_int(), 65);
  EXPECT_THAT(bad[0].child("title").text().get(), testing::StartsWith("sample 18, feature "));
  const auto crosses = chart.all("//g[@class='out']/path");
  ASSERT_EQ(crosses.size(), 1u);
  EXPECT_EQ(crosses[0].attribute("data-sample").as_int(), 37);
  const auto target = chart.all("//circle[@class='target' and @r>=8]");
  ASSERT_EQ(target.size(), 1u) << "a cross alone is hard to click";
  EXPECT_EQ(target[0].attribute("data-sample").as_int(), 37);
  EXPECT_STREQ(target[0].child("title").text().get(), "sample 37: left out");
}

TEST(SampleCharts, ASampleThatWasLeftOutIsACrossAndDoesNotStretchTheAxis) {
  ReportData data = test::report_data(8);
  const std::string before = test::chart_named(sample_charts(data), "samples-ground").svg;
  for (ReportedBlock& block : data.blocks) {
    for (ReportedFeature& feature : block.features) {
      if (feature.sample == 3) feature.after = 0.7;
    }
  }
  data.samples[3].left_out = true;
  const test::SvgChart chart(test::chart_named(sample_charts(data), "samples-ground"));
  const auto target = chart.all("//g[@class='out']/circle");
  ASSERT_EQ(target.size(), 1u);
  EXPECT_EQ(target[0].attribute("data-sample").as_int(), 4);
  EXPECT_THAT(target[0].child("title").text().get(), testing::HasSubstr("700 mm, left out"));
  EXPECT_LT(chart.value('y', target[0].attribute("cy").as_double()), 100.0) << "at the edge";
  EXPECT_TRUE(chart.all("//g[starts-with(@class, 'dots')]/path[@data-sample='4']").empty());
}

TEST(FeatureCharts, NameTheFeatureThatFitsWorst) {
  ReportData data = test::report_data();
  for (ReportedFeature& feature : data.blocks[0].features) {
    feature.feature.id = 100 + feature.feature.place;
  }
  const Chart chart = test::chart_named(feature_charts(data), "features-hand_eye");
  EXPECT_THAT(test::SvgChart(chart).text("/svg/desc"),
              testing::HasSubstr("largest for feature 102,"));
}

TEST(FeatureCharts, OfManyFeaturesTheWorstAreShownAndItIsSaid) {
  const ReportData data = test::report_data(5, 300);
  const Chart chart = test::chart_named(feature_charts(data), "features-hand_eye");
  EXPECT_THAT(chart.caption,
              testing::HasSubstr("Of 300 features, the 48 with the largest medians"));
  EXPECT_EQ(test::SvgChart(chart).all("//path[@class='area after']").size(), 48u);
}

TEST(DepthCharts, ThePlanesErrorHasItsSign) {
  ReportData data = test::report_data(30);
  for (ReportedFeature& feature : data.blocks[2].features) {
    feature.residual = {-2e-3};
    feature.after = 2e-3;
  }
  const test::SvgChart chart(test::chart_named(depth_charts(data), "depth-ground"));
  for (const pugi::xml_node& path : chart.all("//g/path")) {
    EXPECT_NEAR(chart.value('y', test::numbers_of(path)[1]), -2.0, 0.03);
  }
  const auto median = chart.all("//path[@class='median']");
  ASSERT_EQ(median.size(), 2u) << "and in the legend";
  EXPECT_NEAR(chart.value('y', test::numbers_of(median[0])[1]), -2.0, 0.03);
}

}  // namespace
}  // namespace kinecal
