// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/errors.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/report/charts/held_out.hpp"
#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

/// Coordinates have one digit; on an axis of 460 units a decade is at least 90.
constexpr double kDrawnTo = 0.01;

TEST(ErrorCharts, MediansAndNoiseStandAtTheirValues) {
  ReportData data = test::report_data(40);
  data.blocks.resize(1);
  ReportedBlock& block = data.blocks[0];
  std::vector<double> before, after;
  for (const ReportedFeature& feature : block.features) {
    if (detail::sample_of(data, feature).left_out) continue;
    before.push_back(1e3 * feature.before);
    after.push_back(1e3 * feature.after);
  }
  const std::vector<Chart> all = error_charts(data);
  ASSERT_EQ(all.size(), 1u);
  const test::SvgChart chart(all[0]);
  const auto value_of = [&](const char* path) {
    const auto marks = chart.all(path);
    EXPECT_FALSE(marks.empty()) << path;
    return chart.value('x', test::numbers_of(marks.back())[0], true);
  };
  const double median_before = detail::quantile(detail::sorted_finite(before), 0.5);
  const double median_after = detail::quantile(detail::sorted_finite(after), 0.5);
  EXPECT_NEAR(value_of("//path[@class='before thick']"), median_before, kDrawnTo * median_before);
  EXPECT_NEAR(value_of("//path[@class='after thick']"), median_after, kDrawnTo * median_after);
  const double expected = 1e3 * block.sigma * std::sqrt(3.0), given = 1e3 * std::sqrt(3.0) * 1e-3;
  EXPECT_NEAR(value_of("//path[@class='sigma']"), expected, kDrawnTo * expected);
  EXPECT_NEAR(value_of("//path[@class='given']"), given, kDrawnTo * given);
  EXPECT_THAT(chart.text("/svg/desc"), testing::HasSubstr("hand_eye: median "));
}

TEST(ErrorCharts, BlocksOfOneUnitShareAnAxisAndSamplesLeftOutAreNotInThem) {
  ReportData data = test::report_data(40);
  const std::vector<Chart> all = error_charts(data);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "errors-mm");
  EXPECT_EQ(all[1].name, "errors-px");
  EXPECT_EQ(test::SvgChart(all[0]).all("//text[@class='strong']").size(), 2u);
  for (ReportedSample& sample : data.samples) sample.left_out = true;
  EXPECT_TRUE(error_charts(data).empty());
}

TEST(ErrorCharts, ErrorsOfExactlyZeroAreAtTheLeftEnd) {
  ReportData data = test::report_data(10);
  data.blocks.resize(1);
  for (ReportedFeature& feature : data.blocks[0].features) feature.after = 0.0;
  const test::SvgChart chart(error_charts(data)[0]);
  const auto marks = chart.all("//path[@class='after thick']");
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(test::numbers_of(marks[0])[0], 10.0);
}

TEST(HeldOutCharts, BarsAreAsLongAsTheirFigures) {
  ReportData data = test::report_data(10);
  data.blocks.resize(1);
  data.blocks[0].rms_before = 8e-3;
  data.blocks[0].rms_after = 2e-3;
  data.blocks[0].held_out = 3e-3;
  const test::SvgChart chart(held_out_charts(data)[0]);
  const auto bars = chart.all("//rect");
  ASSERT_EQ(bars.size(), 3u);
  const double unit = bars[0].attribute("width").as_double() / 8.0;
  EXPECT_NEAR(bars[1].attribute("width").as_double(), 2.0 * unit, 0.1);
  EXPECT_NEAR(bars[2].attribute("width").as_double(), 3.0 * unit, 0.1);
  EXPECT_EQ(chart.text("//text[@class='small figure'][3]"), "3.000 mm");
}

}  // namespace
}  // namespace kinecal
