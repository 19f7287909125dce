// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/cameras.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

/// Two cameras: the second sees each third sample only.
ReportData of_two_cameras(int samples) {
  ReportData data = test::report_data(samples);
  data.blocks.resize(2);
  data.blocks[0].cameras = {"left_eye"};
  data.blocks[1].cameras = {"right_eye"};
  std::erase_if(data.blocks[1].features, [](const auto& seen) { return seen.sample % 3 != 0; });
  return data;
}

TEST(CameraCharts, HaveAMarkWhereACameraSawASample) {
  const ReportData data = of_two_cameras(12);
  const test::SvgChart svg(test::chart_named(camera_charts(data), "cameras"));
  EXPECT_EQ(svg.all("//rect[@data-sample]").size(), 12u + 4u);
  EXPECT_EQ(svg.all("//rect[@data-sample='4']").size(), 2u);
  EXPECT_EQ(svg.all("//rect[@data-sample='5']").size(), 1u);
  EXPECT_THAT(svg.text("/svg/desc"), testing::HasSubstr("left_eye 12, right_eye 4"));
  EXPECT_THAT(svg.all("//rect[@data-sample='4']")[1].child("title").text().get(),
              testing::StartsWith("right_eye, sample 4: 4 features, "));
}

TEST(CameraCharts, ColourWhatDoesNotFit) {
  ReportData data = of_two_cameras(12);
  for (ReportedFeature& feature : data.blocks[0].features) {
    if (feature.sample == 6) feature.after = 0.1;
  }
  const test::SvgChart svg(test::chart_named(camera_charts(data), "cameras"));
  const auto bad = svg.all("//rect[@class='bad' and @data-sample]");
  ASSERT_EQ(bad.size(), 1u);
  EXPECT_EQ(bad[0].attribute("data-sample").as_int(), 7);
}

TEST(CameraCharts, AreEmptyOfASingleCamera) {
  ReportData data = of_two_cameras(5);
  data.blocks[1].cameras = {"left_eye"};
  EXPECT_TRUE(camera_charts(data).empty());
  EXPECT_TRUE(camera_charts(test::report_data(5)).empty());
}

TEST(CameraCharts, OfManySamplesShowSome) {
  const ReportData data = of_two_cameras(3000);
  const Chart chart = test::chart_named(camera_charts(data), "cameras");
  EXPECT_THAT(chart.caption, testing::HasSubstr(" of 3001 samples are shown"));
  EXPECT_LE(test::SvgChart(chart).all("//rect[@data-sample]").size(), 2000u);
}

}  // namespace
}  // namespace kinecal
