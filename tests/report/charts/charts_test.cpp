// SPDX-License-Identifier: Apache-2.0
#include "kinecal/report/charts/charts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "support/report_data.hpp"
#include "support/svg_chart.hpp"

namespace kinecal {
namespace {

/// Parses all and expects what holds for every chart.
void expect_sound(const std::vector<Chart>& all) {
  std::set<std::string> ids, names;
  for (const Chart& chart : all) {
    const test::SvgChart svg(chart);
    EXPECT_EQ(chart.name, svg.root().attribute("data-chart").value());
    EXPECT_TRUE(names.insert(chart.name).second) << chart.name << " twice";
    EXPECT_FALSE(svg.text("/svg/desc").empty()) << chart.name;
    EXPECT_FALSE(chart.title.empty() || chart.section.empty()) << chart.name;
    for (const pugi::xml_node& node : svg.all("//*[@id]")) {
      EXPECT_TRUE(ids.insert(node.attribute("id").value()).second) << chart.name;
    }
    for (const pugi::xml_node& node : svg.all("//*")) {
      for (const char* name : {"d", "x", "y", "cx", "cy", "r", "width", "height"}) {
        EXPECT_EQ(std::string(node.attribute(name).value()).find("n"), std::string::npos)
            << chart.name << ": nan or inf";
      }
    }
    EXPECT_LE(svg.all("//*").size(), 5000u) << chart.name;
  }
}

TEST(Charts, AreWellFormedDescribedAndOfOneName) {
  const std::vector<Chart> all = charts(test::report_data());
  EXPECT_EQ(all.size(), 24u);
  expect_sound(all);
}

TEST(Charts, DashedLinesHaveALegend) {
  int dashed = 0;
  for (const Chart& chart : charts(test::report_data())) {
    const test::SvgChart svg(chart);
    for (const char* kind : {"sigma", "given"}) {
      int swatches = 0, lines = 0;
      for (const auto& path : svg.all(("//path[@class='" + std::string(kind) + "']").c_str())) {
        const std::vector<double> ends = test::numbers_of(path);
        ASSERT_EQ(ends.size(), 4u);
        const bool is_swatch = ends[1] == ends[3] && ends[2] - ends[0] == 20.0;
        (is_swatch && path.next_sibling("text") ? swatches : lines) += 1;
      }
      EXPECT_EQ(swatches, lines > 0 ? 1 : 0) << chart.name << ": " << kind;
      dashed += lines;
    }
  }
  EXPECT_GT(dashed, 6);
}

TEST(Charts, OfASectionAreTogether) {
  std::vector<std::string> sections;
  for (const Chart& chart : charts(test::report_data())) {
    if (sections.empty() || sections.back() != chart.section) sections.push_back(chart.section);
  }
  EXPECT_THAT(sections, testing::ElementsAre("errors", "search", "residuals", "pixels", "depth",
                                             "planes", "workspace", "parameters", "convergence"));
}

TEST(Charts, AreTheSameBytesForTheSameDataAndSmall) {
  const std::vector<Chart> first = charts(test::report_data()),
                           second = charts(test::report_data());
  ASSERT_EQ(first.size(), second.size());
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].svg, second[i].svg);
    bytes += first[i].svg.size();
  }
  EXPECT_LT(bytes, 400'000u) << "100 samples of four features and three error blocks";
}

TEST(Charts, NothingToDrawIsNoChart) {
  EXPECT_TRUE(charts({}).empty());
}

TEST(Charts, OneSampleAndOneFeatureAreDrawn) {
  const std::vector<Chart> all = charts(test::report_data(1, 1));
  expect_sound(all);
  EXPECT_EQ(test::SvgChart(test::chart_named(all, "samples-hand_eye")).all("//g/path").size(), 1u);
}

TEST(Charts, NamesOfAnyKindAreShownAndNeverMarkup) {
  for (const std::string& name :
       {std::string("<script>alert(1)</script>"), std::string("\"quotes'"), std::string("🤖🦾"),
        std::string(5000, 'a'), std::string("זרוע הרובוט"), std::string("\x1b[31m\xff"),
        std::string("]]>--><!--")}) {
    ReportData data = test::report_data(6);
    for (ReportedBlock& block : data.blocks) block.name = name;
    for (ReportedParameter& parameter : data.parameters) parameter.name = parameter.owner = name;
    for (std::string& correlated : data.correlated) correlated = name;
    data.unobservable[0][0].first = data.steps[0].name = name;
    const std::vector<Chart> all = charts(data);
    expect_sound(all);
    for (const Chart& chart : all) {
      EXPECT_TRUE(test::SvgChart(chart).all("//script").empty());
      EXPECT_THAT(chart.name, testing::MatchesRegex("[a-z0-9_-]+"));
    }
  }
}

TEST(Charts, BadNumbersAreLeftOut) {
  for (const double bad :
       {test::kNan, test::kInfinity, -test::kInfinity, 0.0, 1e300, -1e300, 1e-300}) {
    ReportData data = test::report_data(6);
    for (ReportedBlock& block : data.blocks) {
      block.sigma = block.rms_before = bad;
      block.held_out = bad;
      for (ReportedFeature& feature : block.features) {
        feature.before = feature.after = bad;
        for (double& r : feature.residual) r = bad;
        if (feature.depth) feature.depth = bad;
        if (feature.pixel) (*feature.pixel)[0] = bad;
        if (feature.point) (*feature.point)[1] = bad;
      }
    }
    for (ReportedParameter& parameter : data.parameters) {
      parameter.value = bad;
      parameter.sigma = bad;
    }
    for (auto& row : data.correlation) std::fill(row.begin(), row.end(), bad);
    data.correlation.pop_back();  // of another size than the names
    for (StepResult& step : data.steps) std::fill(step.costs.begin(), step.costs.end(), bad);
    data.steps[1].starts.minima[0].cost = bad;
    for (KnownPoint& point : data.workspace) point.deviation = bad;
    data.unobservable[0][0].second = bad;
    expect_sound(charts(data));
  }
}

TEST(Charts, ABadNumberAmongGoodOnesHidesOnlyItself) {
  ReportData data = test::report_data(20);
  data.blocks[0].features[5].after = test::kNan;
  data.blocks[0].features[6].before = test::kInfinity;
  data.blocks[0].features[7].sample = 4711;  // no such sample
  data.blocks[0].features[8].sample = -1;
  const std::vector<Chart> all = charts(data);
  expect_sound(all);
  EXPECT_THAT(test::SvgChart(test::chart_named(all, "samples-hand_eye")).text("/svg/desc"),
              testing::HasSubstr("Distances of 79 features"));
}

TEST(Charts, OfManyFeaturesTheWorstAreDrawnAndItIsSaid) {
  ReportData data = test::report_data(1000);
  data.blocks.resize(1);
  std::vector<ReportedFeature>& features = data.blocks[0].features;
  const std::vector<ReportedFeature> once = features;
  for (int i = 1; i < 50; ++i) features.insert(features.end(), once.begin(), once.end());
  features[123456].after = 0.5;
  const std::vector<Chart> all = charts(data);
  expect_sound(all);
  const Chart& chart = test::chart_named(all, "samples-hand_eye");
  EXPECT_THAT(chart.caption, testing::HasSubstr("2000 of 200\u2009000 features are shown"));
  const test::SvgChart svg(chart);
  std::size_t dots = 0;
  for (const pugi::xml_node& path : svg.all("//g[starts-with(@class, 'dots')]/path")) {
    dots += (test::numbers_of(path).size()) / 3;
  }
  EXPECT_EQ(dots, 2000u);
  const std::string number = std::to_string(detail::sample_number(data, features[123456]));
  EXPECT_EQ(svg.all(("//path[@data-sample='" + number + "']/title").c_str()).size(), 1u);
  EXPECT_THAT(svg.text("/svg/desc"), testing::HasSubstr("500 mm"));
}

TEST(Charts, TheWorstMarksAndAnEvenChoiceAreTaken) {
  std::vector<double> sizes(1000, 1.0);
  for (const std::size_t i : {3u, 500u, 999u}) sizes[i] = 9.0;
  sizes[7] = test::kNan;
  const std::vector<std::size_t> chosen = detail::chosen_marks(sizes, 100);
  EXPECT_EQ(chosen.size(), 100u);
  EXPECT_THAT(chosen, testing::IsSupersetOf({3u, 500u, 999u}));
  EXPECT_THAT(chosen, testing::Not(testing::Contains(7u)));
  EXPECT_TRUE(std::is_sorted(chosen.begin(), chosen.end()));
  const auto in_second_half =
      std::count_if(chosen.begin(), chosen.end(), [](std::size_t i) { return i >= 500; });
  EXPECT_NEAR(static_cast<double>(in_second_half), 0.5 * 90, 5.0) << "but for the worst ten";
}

}  // namespace
}  // namespace kinecal
