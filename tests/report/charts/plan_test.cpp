// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/report/charts/pose_curve.hpp"
#include "kinecal/report/charts/position_spread.hpp"
#include "kinecal/report/charts/spread.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::Not;

/// No coordinate is nan or inf.
void expect_finite(const test::SvgChart& chart) {
  for (const pugi::xml_node& node : chart.all("//*")) {
    for (const char* name : {"d", "x", "y", "cx", "cy", "width", "height"}) {
      EXPECT_THAT(node.attribute(name).value(), Not(HasSubstr("n")));
    }
  }
}

PoseCurve pose_curve() {
  PoseCurve curve;
  for (int i = 1; i <= 40; ++i) {
    curve.selected.push_back({i, i < 3 ? test::kInfinity : 2e-3 / std::sqrt(i)});
    if (i % 5 == 0) curve.random.push_back({i, 3e-3 / std::sqrt(i)});
  }
  curve.wanted = 0.5e-3;
  curve.knee = 14;
  curve.enough = {16, 0.5e-3};
  return curve;
}

TEST(PoseCurve, DotsStandAtTheirPosesAndPositions) {
  const test::SvgChart chart(pose_curve_chart(pose_curve()));
  expect_finite(chart);
  const auto dots = chart.all("//circle[@class='after' and title]");
  ASSERT_EQ(dots.size(), 39u) << "the first two are not determined, the knee is larger";
  EXPECT_NEAR(chart.value('x', dots[6].attribute("cx").as_double()), 9.0, 0.1);
  EXPECT_NEAR(chart.value('y', dots[6].attribute("cy").as_double(), true), 2.0 / 3.0, 0.01);
  EXPECT_EQ(chart.all("//circle[@class='before' and title]").size(), 8u);
  const auto wanted = test::numbers_of(chart.all("//path[@class='sigma']").back());
  EXPECT_NEAR(chart.value('y', wanted[1], true), 0.5, 0.01);
  const auto knee = test::numbers_of(chart.all("//path[@class='faint']").back());
  EXPECT_NEAR(chart.value('x', knee[0]), 14.0, 0.1);
  EXPECT_EQ(chart.text("//text[@class='small strong']"), "knee: 14 poses");
  EXPECT_EQ(chart.all("//text[.='16 poses: 0.5 mm']").size(), 1u);
  EXPECT_THAT(chart.text("/svg/desc"), HasSubstr("Selected: 3 poses: 1.15 mm; 40 poses: 0.316 mm"));
}

TEST(PoseCurve, WithoutAKneeOrWithAnErrorThatRemainsItSaysSo) {
  PoseCurve curve = pose_curve();
  curve.knee.reset();
  curve.enough.reset();
  curve.remaining = 39e-3;
  const Chart drawn = pose_curve_chart(curve);
  EXPECT_THAT(drawn.caption, HasSubstr("No knee within 40 poses."));
  EXPECT_THAT(drawn.caption, HasSubstr("without noise calibrations are 39 mm off"));
  const test::SvgChart chart(drawn);
  EXPECT_TRUE(chart.all("//circle[@class='good']").empty());
  EXPECT_EQ(chart.text("//text[@class='small strong']"), "");
}

TEST(PoseCurve, BeginsAtThePosesThatExist) {
  PoseCurve curve = pose_curve();
  curve.selected = {{0, 1e-3}, {1, 0.9e-3}, {2, 0.8e-3}};
  curve.have = 12;
  curve.enough = {0, 1e-3};
  const test::SvgChart chart(pose_curve_chart(curve));
  expect_finite(chart);
  EXPECT_EQ(chart.all("//text[.='your 12 poses: 1 mm']").size(), 1u);
  EXPECT_EQ(chart.all("//text[.='more poses']").size(), 1u);
  EXPECT_TRUE(chart.all("//circle[@class='good']").empty()) << "no more are needed";
}

TEST(PoseCurve, WhatIsNotDeterminedOrFarAwayIsNoCurve) {
  PoseCurve curve;
  test::SvgChart empty(pose_curve_chart(curve));
  expect_finite(empty);
  for (int i = 1; i < 9; ++i) curve.selected.push_back({i, test::kInfinity});
  curve.wanted = 1e-9;
  const test::SvgChart chart(pose_curve_chart(curve));
  expect_finite(chart);
  EXPECT_TRUE(chart.all("//circle[title]").empty());
  EXPECT_THAT(chart.text("/svg/desc"), HasSubstr("not determined"));
  EXPECT_THAT(pose_curve_chart(curve).caption, HasSubstr("What is asked for is not reached."));
}

TEST(Spread, IntervalIsThatOfChi) {
  // Of chi-square: 0.000982 and 5.0239 with one degree of freedom, 2.7004 and 19.0228 with 9.
  EXPECT_NEAR(spread_interval(1).first, std::sqrt(0.000982), 1e-4);
  EXPECT_NEAR(spread_interval(1).second, std::sqrt(5.0239), 1e-4);
  EXPECT_NEAR(spread_interval(9).first, std::sqrt(2.7004 / 9.0), 1e-4);
  EXPECT_NEAR(spread_interval(9).second, std::sqrt(19.0228 / 9.0), 1e-4);
  EXPECT_NEAR(spread_interval(9, 0.005).first, std::sqrt(1.7349 / 9.0), 1e-4);
  EXPECT_NEAR(spread_interval(9, 0.005).second, std::sqrt(23.5894 / 9.0), 1e-4);
}

TEST(Spread, DotsStandAtTheirRatios) {
  const SpreadRatios ratios{
      {"pan", "<tilt>", "lift"},
      {{"100 poses", 27, {1.1, 0.5, test::kNan}}, {"25 poses", 27, {0.9, 1.0, 0}}}};
  const Chart drawn = spread_chart(ratios);
  const test::SvgChart chart(drawn);
  expect_finite(chart);
  const auto dots = chart.all("//circle[@class='after' and title]");
  ASSERT_EQ(dots.size(), 2u);
  EXPECT_NEAR(chart.value('x', dots[0].attribute("cx").as_double(), true), 1.1, 0.01);
  EXPECT_NEAR(chart.value('x', dots[1].attribute("cx").as_double(), true), 0.5, 0.01);
  EXPECT_EQ(chart.all("//circle[@class='ring before' and title]").size(), 2u);
  EXPECT_EQ(chart.all("//text[.='<tilt>']").size(), 1u);
  EXPECT_EQ(chart.all("//text[.='not determined']").size(), 1u);
  const auto interval = chart.all("//rect[@class='pale']");
  ASSERT_EQ(interval.size(), 2u) << "one in the legend";
  EXPECT_NEAR(chart.value('x', interval[1].attribute("x").as_double(), true),
              spread_interval(27).first, 0.01);
  EXPECT_THAT(drawn.caption, HasSubstr("1 of 2 determined parameters are outside"));
}

TEST(Spread, OfManyParametersThoseFarthestFromOneAreShown) {
  SpreadRatios ratios{{}, {{"9 poses", 9, {}}}};
  for (int i = 0; i < 100; ++i) {
    ratios.parameters.push_back("p" + std::to_string(i));
    ratios.series[0].ratios.push_back(i == 77 ? 1e-9 : 1.0);
  }
  const Chart drawn = spread_chart(ratios);
  const test::SvgChart chart(drawn);
  expect_finite(chart);
  EXPECT_EQ(chart.all("//text[.='p77']").size(), 1u);
  EXPECT_THAT(drawn.caption, HasSubstr("The 60 farthest from one of 100 parameters are shown."));
  expect_finite(test::SvgChart(spread_chart({})));
}

TEST(PositionSpread, DotsStandAtTheirPosesAndPositions) {
  const test::SvgChart chart(position_spread_chart({{25, 1.0e-3, 0.9e-3, 5e-3},
                                                    {50, 0.7e-3, test::kInfinity, 5e-3},
                                                    {100, 0.5e-3, 0.4e-3, 5e-3}}));
  expect_finite(chart);
  const auto varied = chart.all("//circle[@class='after' and title]");
  ASSERT_EQ(varied.size(), 3u);
  EXPECT_NEAR(chart.value('x', varied[1].attribute("cx").as_double()), 50.0, 0.1);
  EXPECT_NEAR(chart.value('y', varied[1].attribute("cy").as_double()), 0.7, 0.01);
  EXPECT_EQ(chart.all("//circle[@class='ring before' and title]").size(), 2u);
  EXPECT_THAT(chart.text("/svg/desc"),
              HasSubstr("25 poses: off 5 mm, varied 1 mm, predicted 0.9 mm."));
  const auto off = chart.all("//circle[@class='bad' and title]");
  ASSERT_EQ(off.size(), 3u);
  EXPECT_NEAR(chart.value('y', off[0].attribute("cy").as_double()), 5.0, 0.01);
  expect_finite(test::SvgChart(position_spread_chart({})));
}

}  // namespace
}  // namespace kinecal
