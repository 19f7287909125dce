// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

test::SvgChart drawn(const ReportData& data) {
  const std::vector<Chart> all = search_charts(data);
  EXPECT_EQ(all.size(), 1u);
  return test::SvgChart(all.front());
}

TEST(SearchChart, HasABarForEachStepAndMarksTheChosenSet) {
  const test::SvgChart chart = drawn(test::report_data());
  EXPECT_EQ(chart.all("//circle[@class='held' and title]").size(), 5u) << "the base and four more";
  EXPECT_EQ(chart.all("//circle[@class='faint' and title]").size(), 1u) << "not freed";
  EXPECT_EQ(chart.all("//path[@class='median']").size(), 15u) << "a bar with two ends each";
  EXPECT_EQ(chart.all("//circle[@class='ring after' and @r='9']").size(), 1u);
  EXPECT_THAT(chart.text("/svg/desc"), HasSubstr("Before: 9 parameters: 5.2 ± 0.36 mm. Chosen: 14 "
                                                 "parameters: 0.46 ± 0.032 mm."));
}

TEST(SearchChart, BarsAreOneStandardErrorOnBothSides) {
  ReportData data = test::report_data();
  data.search.steps.resize(2);
  data.search.steps[0].held_out = 2e-3;
  data.search.steps[1].held_out = 1e-3;
  for (ReportedSearchStep& step : data.search.steps) {
    step.fitted = step.held_out;
    step.deviation = 0.2e-3;  // a linear axis
  }
  const test::SvgChart chart = drawn(data);
  const auto circles = chart.all("//circle[@class='held' and title]");
  const double per_metre =
      (circles[1].attribute("cy").as_double() - circles[0].attribute("cy").as_double()) / 1e-3;
  const std::vector<double> bar = test::numbers_of(chart.all("//path[@class='median']").front());
  EXPECT_NEAR(bar[3] - bar[1], 0.4e-3 * per_metre, 0.21) << "coordinates have one decimal";
}

TEST(SearchChart, LeavesOutWhatAFoldDoesNotDetermine) {
  ReportData data = test::report_data();
  data.search.steps[1].held_out = std::numeric_limits<double>::infinity();
  data.search.steps[1].deviation = 0.0;
  EXPECT_EQ(drawn(data).all("//circle[@class='held' and title]").size(), 4u);
}

TEST(SearchChart, IsOnlyOfASearch) {
  ReportData data = test::report_data();
  data.search = {};
  EXPECT_THAT(search_charts(data), IsEmpty());
}

}  // namespace
}  // namespace kinecal
