// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/pixels.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>

#include "kinecal/report/charts/planes.hpp"
#include "kinecal/report/charts/radial.hpp"
#include "kinecal/report/charts/workspace.hpp"
#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

/// A feature at a pixel with a residual of two components.
ReportedFeature seen(int sample, double x, double y, double u, double v) {
  ReportedFeature feature;
  feature.sample = sample;
  feature.pixel = {{x, y}};
  feature.residual = {u, v};
  feature.after = std::hypot(u, v);
  return feature;
}

ReportData with_pixels(const std::vector<ReportedFeature>& features) {
  ReportData data;
  ReportedBlock block;
  block.name = "camera";
  block.unit = "px";
  block.components = 2;
  block.image = {640.0, 480.0};
  block.features = features;
  data.blocks = {block};
  for (int i = 0; i < 9; ++i) data.samples.push_back({i + 1, "", false, false, "", 0.0});
  return data;
}

TEST(PixelCharts, ArrowsBeginAtThePixelAndPointAlongTheResidual) {
  const test::SvgChart chart(
      pixel_charts(with_pixels({seen(0, 320.0, 240.0, 1.0, 0.0), seen(4, 100.0, 60.0, 0.0, -0.5)}))
          .at(0));
  const pugi::xml_node frame = chart.all("//rect[@class='frame']").at(0);
  const double scale = frame.attribute("width").as_double() / 640.0;
  EXPECT_NEAR(frame.attribute("height").as_double(), 480.0 * scale, 0.1);
  const auto arrows = chart.all("//g[@class='arrows']/path[@data-sample]");
  ASSERT_EQ(arrows.size(), 2u);
  EXPECT_EQ(arrows[1].attribute("data-sample").as_int(), 5);
  const std::vector<double> right = test::numbers_of(arrows[0]), up = test::numbers_of(arrows[1]);
  EXPECT_NEAR(right[0], frame.attribute("x").as_double() + 320.0 * scale, 0.1);
  EXPECT_NEAR(right[1], frame.attribute("y").as_double() + 240.0 * scale, 0.1);
  EXPECT_EQ(right[1], right[3]);
  EXPECT_EQ(up[0], up[2]);
  EXPECT_NEAR(up[3] - up[1], -0.5 * (right[2] - right[0]), 0.15) << "half as long, upwards";
}

TEST(PixelCharts, TheLegendSaysHowMuchLongerArrowsAre) {
  const test::SvgChart chart(pixel_charts(with_pixels({seen(0, 320.0, 240.0, 1.0, 0.0)})).at(0));
  const std::vector<double> arrow =
      test::numbers_of(chart.all("//g[@class='arrows']/path[@data-sample]").at(0));
  const double scale =
      chart.all("//rect[@class='frame']").at(0).attribute("width").as_double() / 640;
  const double times = (arrow[2] - arrow[0]) / scale;
  const std::string text = chart.text("//text[@class='small']");
  EXPECT_NEAR(std::atof(text.c_str() + text.find(": ") + 2), times, 0.01 * times) << text;
}

TEST(PixelCharts, AnImageOfUnknownSizeIsWhatTheFeaturesCover) {
  ReportData data = with_pixels({seen(0, 100.0, 50.0, 1.0, 0.0), seen(1, 300.0, 150.0, 1.0, 0.0)});
  data.blocks[0].image = {0.0, 0.0};
  const test::SvgChart chart(pixel_charts(data).at(0));
  EXPECT_EQ(chart.text("//text[@class='small quiet']"), "200 × 100 px, what the features cover");
}

TEST(RadialCharts, AMissingLensTermLeavesZeroTowardsTheRim) {
  std::vector<ReportedFeature> features;
  for (int i = 0; i < 200; ++i) {
    const double angle = 2.4 * i, radius = 1.9 * i;
    const double x = radius * std::cos(angle), y = radius * std::sin(angle), k = 1e-5 * radius;
    features.push_back(seen(i % 9, 320.0 + x, 240.0 + y, k * x, k * y));
  }
  const test::SvgChart chart(radial_charts(with_pixels(features)).at(0));
  const auto medians = chart.all("//path[@class='median']");
  ASSERT_EQ(medians.size(), 3u) << "legend, outwards, across";
  const std::vector<double> outwards = test::numbers_of(medians[1]),
                            across = test::numbers_of(medians[2]);
  EXPECT_LT(outwards.back(), outwards[1] - 20.0) << "rises";
  EXPECT_NEAR(across.back(), across[1], 0.2) << "stays at zero";
}

TEST(PlaneCharts, PointsStandWhereTheyLieInTheColourOfTheirSign) {
  ReportData data;
  ReportedBlock block;
  block.name = "ground";
  block.unit = "m";
  block.is_plane = true;
  const auto add = [&](double x, double y, double error) {
    ReportedFeature feature;
    feature.point = {{x, y, 0.0}};
    feature.residual = {error};
    feature.after = std::abs(error);
    block.features.push_back(feature);
  };
  add(1.0, -0.5, 4e-3);
  add(2.0, 0.5, -4e-3);
  data.blocks = {block};
  const test::SvgChart chart(plane_charts(data).at(0));
  const auto points = chart.all("//circle[@data-sample]");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_THAT(points[0].attribute("class").value(), testing::StartsWith("plus"));
  EXPECT_THAT(points[1].attribute("class").value(), testing::StartsWith("minus"));
  EXPECT_NEAR(chart.value('x', points[1].attribute("cx").as_double()), 2.0, 0.005);
  EXPECT_NEAR(chart.value('y', points[0].attribute("cy").as_double()), -0.5, 0.005);
}

/// The cells of a map: those of equal width and height.
std::vector<pugi::xml_node> cells_of(const test::SvgChart& chart, const std::string& classes) {
  return chart.all(("//rect[@class='" + classes + "' and @width=@height]").c_str());
}

TEST(WorkspaceCharts, OfPointsBehindOneAnotherTheWorstIsShown) {
  ReportData data;
  data.workspace = {
      {{{0.5, 0.0, 0.2}}, 5e-3}, {{{0.5, 0.0, 0.9}}, 1e-3}, {{{0.9, 0.3, 0.2}}, 1e-3}};
  const test::SvgChart chart(workspace_charts(data).at(0));
  EXPECT_EQ(cells_of(chart, "scale5").size(), 2u) << "from above and the side";
  EXPECT_EQ(cells_of(chart, "scale1").size(), 3u) << "one of them hidden; all others are blank";
  EXPECT_STREQ(cells_of(chart, "scale5")[0].child("title").text().get(), "5 mm");
  EXPECT_THAT(chart.text("/svg/desc"), testing::HasSubstr("at 3 places, from 1 to 5 mm"));
}

TEST(WorkspaceCharts, AreMapsOfEqualScaleWithTheBaseAndABarOfColors) {
  ReportData data;
  for (int i = 0; i < 40; ++i) data.workspace.push_back({{{0.02 * i, 0.3, 1.0}}, 1e-3 + 1e-4 * i});
  const test::SvgChart chart(workspace_charts(data).at(0));
  std::array<std::vector<std::array<double, 2>>, 2> ticks;  // x of the first map, y: place, metres
  for (const pugi::xml_node& tick : chart.all("//text[@class='tick']")) {
    const bool is_x = std::string(tick.attribute("text-anchor").value()) == "middle";
    const double at = tick.attribute(is_x ? "x" : "y").as_double();
    auto& of = ticks[is_x ? 0 : 1];
    const double value = std::atof(tick.text().get());
    if (of.empty() || (of.size() == 1 && of[0][1] != value)) of.push_back({at, value});
  }
  ASSERT_EQ(ticks[0].size() + ticks[1].size(), 4u);
  const auto scale = [](const auto& of) {
    return std::abs((of[1][0] - of[0][0]) / (of[1][1] - of[0][1]));  // units of the drawing a metre
  };
  EXPECT_NEAR(scale(ticks[0]), scale(ticks[1]), 0.02 * scale(ticks[0]));
  const auto bases = chart.all("//text[text()='base']");
  EXPECT_EQ(bases.size(), 2u);
  EXPECT_NEAR(chart.value('x', bases[0].attribute("x").as_double() - 6.0), 0.0, 0.01);
  EXPECT_EQ(chart.all("//rect[@width!=@height and starts-with(@class, 'scale')]").size(), 5u);
  EXPECT_EQ(chart.all("//text[text()='standard deviation of the position, mm']").size(), 1u);
  EXPECT_EQ(chart.all("//text[text()='x, m']").size(), 2u);
}

}  // namespace
}  // namespace kinecal
