// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/parameters.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/report/charts/convergence.hpp"
#include "kinecal/report/charts/correlation.hpp"
#include "kinecal/report/charts/unobservable.hpp"
#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

ReportData with(const std::vector<ReportedParameter>& parameters) {
  ReportData data;
  data.parameters = parameters;
  return data;
}

TEST(ParameterCharts, MarksAndIntervalsStandAtTheirValues) {
  const std::vector<Chart> all =
      parameter_charts(with({{"camera_x", "camera", "m", 0.105, 0.1, 1e-3, ""},
                             {"camera_y", "camera", "m", -0.012, 0.0, 2e-3, ""},
                             {"camera_z", "camera", "m", 1e-4, 0.0, 1e-3, "not significant"}}));
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].name, "parameters-mm");
  const test::SvgChart chart(all[0]);
  constexpr double kDrawn = 0.03;  // mm
  const auto marks = chart.all("//circle[title]");
  ASSERT_EQ(marks.size(), 3u);
  const auto value = [&](const pugi::xml_node& mark) {
    return chart.value('x', mark.attribute("cx").as_double());
  };
  EXPECT_NEAR(value(marks[0]), 5.0, kDrawn) << "added to the initial value";
  EXPECT_NEAR(value(marks[1]), -12.0, kDrawn);
  EXPECT_STREQ(marks[2].attribute("class").value(), "faint");
  const auto intervals = chart.all("//path[@class='after thick']");
  ASSERT_EQ(intervals.size(), 2u);
  const std::vector<double> ends = test::numbers_of(intervals[1]);
  EXPECT_NEAR(chart.value('x', ends[0]), -12.0 - 1.96 * 2.0, kDrawn);
  EXPECT_NEAR(chart.value('x', ends[2]), -12.0 + 1.96 * 2.0, kDrawn);
  EXPECT_EQ(chart.all("//text[.='5.000 ± 1.000 mm']").size(), 1u);
}

TEST(ParameterCharts, TheCaptionSaysWhatTheNumbersAre) {
  const ReportData data = with({{"camera_x", "camera", "m", 0.105, 0.1, 1e-3, ""},
                                {"camera_a", "camera", "rad", 0.1, 0.0, 1e-3, ""}});
  EXPECT_EQ(parameter_charts(data)[1].caption, parameter_charts(data)[0].caption);
  EXPECT_THAT(parameter_charts(data)[0].caption,
              testing::StartsWith("What the calibration added;"));
  EXPECT_THAT(
      parameter_charts(data, "The difference")[0].caption,
      testing::StartsWith("The difference; ±: one standard deviation; bars: 95 % interval."));
}

TEST(ParameterCharts, WhatIsNotDeterminedIsHatchedAndHasNoFigure) {
  const test::SvgChart chart(
      parameter_charts(with({{"pan", "pan", "rad", 0.3, 0.0, std::nullopt, "not determined"}}))[0]);
  EXPECT_EQ(chart.all("//rect[@fill='url(#parameters-deg-hatch)']").size(), 1u);
  EXPECT_TRUE(chart.all("//circle[title]").empty());
  EXPECT_THAT(chart.text("/svg/desc"), HasSubstr("0 significant, 1 not determined"));
}

TEST(ParameterCharts, AParameterFarBeyondTheOthersDoesNotHideThem) {
  std::vector<ReportedParameter> parameters;
  for (int i = 0; i < 8; ++i) {
    parameters.push_back({"x" + std::to_string(i), "x", "m", 1e-3 * (i + 1), 0.0, 1e-4, ""});
  }
  parameters.push_back({"board", "board", "m", 1.25, 0.0, 1e-4, ""});
  const test::SvgChart chart(parameter_charts(with(parameters))[0]);
  EXPECT_EQ(chart.all("//circle[title]").size(), 8u);
  EXPECT_NEAR(chart.value('x', chart.all("//circle[title]")[7].attribute("cx").as_double()), 8.0,
              0.05);
  EXPECT_EQ(chart.all("//text[.='1250.000 ± 0.100 mm']").size(), 1u);
}

TEST(ParameterCharts, AParameterThatIsHardlyDeterminedDoesNotSetTheAxis) {
  const test::SvgChart chart(
      parameter_charts(with({{"pan", "pan", "rad", 0.01, 0.0, 0.5, "hardly determined"},
                             {"tilt", "tilt", "rad", 0.01, 0.0, 1e-3, ""}}))[0]);
  const auto ticks = chart.all("//text[@class='tick']");
  EXPECT_STREQ(ticks.back().text().get(), "0.5") << "degrees: tilt is 0.57";
  EXPECT_EQ(chart.all("//path[@class='faint']").size(), 3u) << "an interval with two arrows";
}

TEST(ParameterCharts, RelativeOnesAreInPerCentAndAnglesInDegrees) {
  const std::vector<Chart> all = parameter_charts(test::report_data());
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[1].name, "parameters-deg");
  EXPECT_EQ(all[2].name, "parameters-percent");
}

TEST(CorrelationCharts, CellsHaveTheirValues) {
  ReportData data;
  data.correlated = {"a", "b", "c"};
  data.correlation = {{1.0, 0.95, 0.02}, {0.95, 1.0, -0.4}, {0.02, -0.4, 1.0}};
  const test::SvgChart chart(correlation_charts(data)[0]);
  const auto cells = chart.all("//rect[title]");
  ASSERT_EQ(cells.size(), 2u) << "what is nearly zero is not drawn";
  EXPECT_STREQ(cells[0].child("title").text().get(), "b, a: 0.95");
  EXPECT_STREQ(cells[0].attribute("class").value(), "plus");
  EXPECT_STREQ(cells[1].child("title").text().get(), "c, b: \u22120.4");
  EXPECT_STREQ(cells[1].attribute("class").value(), "minus l2");
  EXPECT_EQ(cells[0].attribute("y").as_double() - cells[0].attribute("x").as_double(),
            cells[1].attribute("y").as_double() - cells[1].attribute("x").as_double());
}

TEST(CorrelationCharts, OfManyParametersTheMostCorrelatedAreShown) {
  ReportData data;
  constexpr std::size_t kMany = 100;
  data.correlation.assign(kMany, std::vector<double>(kMany, 0.2));
  for (std::size_t i = 0; i < kMany; ++i) data.correlated.push_back("p" + std::to_string(i));
  data.correlation[99][98] = data.correlation[98][99] = -0.97;
  const Chart chart = correlation_charts(data)[0];
  EXPECT_THAT(chart.caption, HasSubstr("The 60 most correlated of 100 parameters are shown."));
  EXPECT_THAT(test::SvgChart(chart).text("/svg/desc"), HasSubstr("p99 and p98, \u22120.97."));
}

TEST(UnobservableCharts, BarsHaveTheSignsOfTheFactors) {
  const test::SvgChart chart(unobservable_charts(test::report_data())[0]);
  const auto bars = chart.all("//rect");
  ASSERT_EQ(bars.size(), 5u);
  EXPECT_STREQ(bars[0].attribute("class").value(), "plus");
  EXPECT_STREQ(bars[1].attribute("class").value(), "minus");
  EXPECT_NEAR(bars[1].attribute("width").as_double() / bars[0].attribute("width").as_double(),
              0.70 / 0.71, 2e-3);
}

TEST(ConvergenceCharts, ACostThatRisesBeginsAnotherCurve) {
  const test::SvgChart chart(convergence_charts(test::report_data())[0]);
  EXPECT_EQ(chart.all("//path[@class='after thick']").size(), 3u) << "one, and two of the camera";
  EXPECT_THAT(chart.text("/svg/desc"), HasSubstr("camera: from 1200 to 518.8 in 6 iterations."));
  const auto numbers = chart.all("//text[@class='tick'][@text-anchor='middle']");
  ASSERT_FALSE(numbers.empty());
  EXPECT_EQ(std::count_if(numbers.begin(), numbers.end(),
                          [](pugi::xml_node at) { return std::string(at.text().get()) == "0"; }),
            2)
      << "each step counts from zero";
}

TEST(StartCharts, TheMinimumThatWasTakenIsMarked) {
  const std::vector<Chart> all = start_charts(test::report_data());
  ASSERT_EQ(all.size(), 1u);
  EXPECT_EQ(all[0].name, "starts-2");
  const test::SvgChart chart(all[0]);
  EXPECT_EQ(chart.all("//rect[@class='good']").size(), 1u);
  EXPECT_EQ(chart.text("//text[@class='small strong']"), "41, taken");
  EXPECT_THAT(all[0].caption, HasSubstr("3 ended at none."));
}

}  // namespace
}  // namespace kinecal
