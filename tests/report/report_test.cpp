#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "kinecal/report/json.hpp"
#include "kinecal/report/text.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

CalibrationResult result() {
  CalibrationResult r;
  r.converged = true;
  r.termination = "converged: \"enough\"\n";
  r.steps.push_back({"one", true, "converged", 5, 2.0, 0.125, 0.001, 30, 2});
  r.blocks.push_back({"hand_eye",
                      "chain3d_to_chain3d",
                      "m",
                      10,
                      {0.01, 0.02, 0.03, 0.04},
                      {0.001, 0.002, 0.003, 0.004}});
  r.table.add({.name = "elbow", .unit = "rad", .initial = 0.0, .value = 0.1});
  r.table.add({.name = "camera_z_offset", .unit = "m", .initial = 0.0, .value = 0.25});
  r.calibrated = {0, 1};
  return r;
}

TEST(JsonReport, IsReadBackAsItWasWritten) {
  // JSON is YAML.
  const YAML::Node json = YAML::Load(json_report(result(), {{1, 2.5, {{{0, 1.0}, {1, -0.5}}}}}));
  EXPECT_TRUE(json["converged"].as<bool>());
  EXPECT_EQ(json["termination"].as<std::string>(), "converged: \"enough\"\n");
  EXPECT_EQ(json["steps"][0]["initial_cost"].as<double>(), 2.0);
  EXPECT_EQ(json["steps"][0]["num_residuals"].as<int>(), 30);
  EXPECT_EQ(json["error_blocks"][0]["after"]["median"].as<double>(), 0.003);
  EXPECT_EQ(json["parameters"][0]["name"].as<std::string>(), "elbow");
  EXPECT_EQ(json["parameters"][0]["value"].as<double>(), 0.1);
  EXPECT_EQ(json["parameters"][1]["unit"].as<std::string>(), "m");
  EXPECT_EQ(json["observability"][0]["rank"].as<int>(), 1);
  EXPECT_EQ(json["observability"][0]["unobservable"][0]["camera_z_offset"].as<double>(), -0.5);
}

TEST(JsonReport, WritesNullForNotANumber) {
  EXPECT_EQ(detail::json_number(std::nan("")), "null");
  EXPECT_EQ(detail::json_number(0.1), "0.1");
  EXPECT_EQ(detail::json_string("a\"b\\c\n"), "\"a\\\"b\\\\c\\u000a\"");
}

TEST(TextReport, ShowsMillimetresAndDegrees) {
  EXPECT_THAT(error_block_table(result()), HasSubstr("10.000  ->  1.000"));
  EXPECT_THAT(parameter_table(result()), HasSubstr("5.730 deg"));
  EXPECT_THAT(parameter_table(result()), HasSubstr("250.000 mm"));
  EXPECT_THAT(step_lines(result()), HasSubstr("2 parameters, 30 residuals"));
}

TEST(TextReport, SaysWhatSolvingTook) {
  CalibrationResult r = result();
  r.steps[0].samples = 100;
  r.steps[0].evaluations = 12;
  r.steps.push_back(r.steps[0]);  // both steps: 10 iterations, 2400 samples in 2 ms
  const std::string set(instruction_set());
  EXPECT_EQ(solving_text(r),
            "solving 0.0020 s (10 iterations, 1.2 million samples a second, " + set + ")");
  r.steps[1].form = CostForm::stacked;
  EXPECT_THAT(solving_text(r), HasSubstr(set + ", stacked cost)"));
  EXPECT_THAT(solving_text({}), HasSubstr("solving 0.0000 s (0 iterations, 0 million"));
}

TEST(TextReport, NamesUnobservableCombinations) {
  const auto table = result().table;
  EXPECT_EQ(observability_text("one", {2, 1.0, {}}, table), "");
  const std::string text = observability_text("one", {1, 2.5, {{{0, 1.0}, {1, -0.5}}}}, table);
  EXPECT_THAT(text, HasSubstr("1 of 2 parameter combinations are observable"));
  EXPECT_THAT(text, HasSubstr("+1 elbow -0.5 camera_z_offset"));
}

TEST(TextReport, WarnsOfADepthOffsetOfAQuarterMetre) {
  const auto lines = suspicious_values(result());
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_THAT(lines[0], HasSubstr("'camera_z_offset'"));
}

TEST(Statistics, AreThoseOfTheDefinition) {
  const Statistics s = statistics_of({3.0, 1.0, 2.0, 10.0}, 3);
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt((9 + 1 + 4 + 100) / 12.0));
  EXPECT_DOUBLE_EQ(s.mean, 4.0);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 10.0);
  EXPECT_EQ(statistics_of({}, 3).max, 0.0);
}

}  // namespace
}  // namespace kinecal
