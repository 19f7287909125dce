#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <limits>

#include "kinecal/report/findings.hpp"
#include "kinecal/report/json.hpp"
#include "kinecal/report/text.hpp"
#include "kinecal/text/name_list.hpp"
#include "support/hostile_names.hpp"
#include "support/shell_words.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

Findings findings() {
  Findings all;
  all.robot = "arm";
  CalibrationResult& r = all.result;
  r.converged = true;
  r.termination = "converged: \"enough\"\n";
  r.steps.push_back({"one", true, "converged", 5, 2.0, 0.125, 0.001, 30, 3});
  r.blocks.push_back({"hand_eye",
                      "chain3d_to_chain3d",
                      "m",
                      10,
                      {0.01, 0.02, 0.03, 0.04},
                      {0.001, 0.002, 0.003, 0.004}});
  r.table.add({.name = "elbow", .unit = "rad", .initial = 0.0, .value = 0.1});
  r.table.add({.name = "camera_z_offset", .unit = "m", .initial = 0.0, .value = 0.25});
  r.table.add({.name = "wrist", .unit = "rad", .initial = 0.0, .value = 0.01});
  r.calibrated = {0, 1, 2};
  Assessment& step = all.assessments.emplace_back();
  step.step = "one";
  step.observability = {2, 2.5, {{{0, 1.0}, {1, -0.5}}}, {1}};
  step.noise = {{.block = "hand_eye",
                 .unit = "m",
                 .features = 10,
                 .components = 3,
                 .freedom = 27.0,
                 .given = 0.002,
                 .sigma = 0.0011,
                 .robust = 0.0010,
                 .unit_sigma = 0.002}};
  step.parameters = {0, 1, 2};
  step.uncertainty.covariance = Eigen::MatrixXd(Eigen::Vector3d(1e-4, 1.0, 1e-4).asDiagonal());
  step.uncertainty.deviation = Eigen::Vector3d(0.01, std::numeric_limits<double>::infinity(), 0.01);
  step.held_out = {{"hand_eye", "m", 10, 0.0017, 0.0021}};
  step.captures = {{.sample = 0, .times = 1.0},
                   {.sample = 1,
                    .feature = {1},
                    .distance = 0.048,
                    .others = 0.003,
                    .times = 43.0,
                    .limit = 6.0,
                    .bad = true}};
  step.compared = {
      PoseUncertainty{.frame = "hand", .in = "camera", .link = "gripper", .position = 0.0005}};
  all.sources = {"samples.yaml:1", "samples.yaml:40"};
  all.numbers = {1, 3};
  all.left_out = {{2, "samples.yaml:20", "--exclude"}};
  all.poses = {{"elbow", "wrist"}, {{0.1, -0.25}, {1.0 / 3.0, 2.0}}};
  all.judgement.add(Grade::use_with_care, "few \"samples\"", {Remedy::Kind::hold});
  return all;
}

TEST(JsonReport, IsReadBackAsItWasWritten) {
  const YAML::Node json = YAML::Load(json_report(findings()));  // JSON is YAML
  EXPECT_EQ(json["verdict"].as<std::string>(), "use with care");
  EXPECT_EQ(json["reasons"][0].as<std::string>(), "few \"samples\"");
  EXPECT_TRUE(json["converged"].as<bool>());
  EXPECT_EQ(json["termination"].as<std::string>(), "converged: \"enough\"\n");
  EXPECT_EQ(json["steps"][0]["initial_cost"].as<double>(), 2.0);
  EXPECT_EQ(json["steps"][0]["num_residuals"].as<int>(), 30);
  EXPECT_EQ(json["error_blocks"][0]["after"]["median"].as<double>(), 0.003);
  EXPECT_EQ(json["noise"][0]["sigma"].as<double>(), 0.0011);
  EXPECT_EQ(json["noise"][0]["sigma_given"].as<double>(), 0.002);
  EXPECT_EQ(json["noise"][0]["held_out"].as<double>(), 0.0021);
  EXPECT_EQ(json["parameters"][0]["name"].as<std::string>(), "elbow");
  EXPECT_EQ(json["parameters"][0]["value"].as<double>(), 0.1);
  EXPECT_EQ(json["parameters"][0]["sigma"].as<double>(), 0.01);
  EXPECT_TRUE(json["parameters"][0]["significant"].as<bool>());
  EXPECT_TRUE(json["parameters"][1]["sigma"].IsNull());
  EXPECT_FALSE(json["parameters"][2]["significant"].as<bool>());
  EXPECT_EQ(json["pose"]["position"].as<double>(), 0.0005);
  EXPECT_EQ(json["observability"][0]["rank"].as<int>(), 2);
  EXPECT_EQ(json["observability"][0]["unobservable"][0]["camera_z_offset"].as<double>(), -0.5);
  EXPECT_EQ(json["observability"][0]["hold"][0].as<std::string>(), "camera_z_offset");
  EXPECT_EQ(json["bad_samples"][0]["sample"].as<int>(), 3);
  EXPECT_EQ(json["left_out"][0]["source"].as<std::string>(), "samples.yaml:20");
}

TEST(JsonReport, HasTheCovarianceAndThePoses) {
  Findings two = findings();  // an earlier step freed the elbow and the ankle
  two.result.table.add({.name = "ankle"});
  Assessment earlier = two.assessments[0];
  earlier.parameters = {0, 3};
  earlier.uncertainty.covariance = Eigen::Matrix2d{{9.0, 8.0}, {8.0, 4.0}};
  two.assessments[0].uncertainty.determined = 2;
  two.assessments.insert(two.assessments.begin(), earlier);
  const YAML::Node json = YAML::Load(json_report(two)), covariance = json["covariance"];
  using Names = std::vector<std::string>;
  EXPECT_EQ(covariance["parameters"].as<Names>(),
            (Names{"elbow", "camera_z_offset", "wrist", "ankle"}));
  using Numbers = std::vector<double>;
  EXPECT_EQ(covariance["lower"][1].as<Numbers>(), (Numbers{0.0, 1.0}));
  EXPECT_EQ(covariance["lower"][3].as<Numbers>(), (Numbers{0.0, 0.0, 0.0, 4.0}));
  EXPECT_EQ(covariance["undetermined"][0]["camera_z_offset"].as<double>(), -0.5);
  EXPECT_EQ(json["noise"][0]["freedom"].as<double>(), 27.0);
  EXPECT_EQ(json["noise"][0]["components"].as<int>(), 3);
  EXPECT_EQ(json["pose"]["link"].as<std::string>(), "gripper");
  EXPECT_EQ(json["poses"]["joints"].as<Names>(), (Names{"elbow", "wrist"}));
  EXPECT_EQ(json["poses"]["positions"][1].as<Numbers>(), (Numbers{0.333333, 2.0}));
}

TEST(JsonReport, IsWrittenOfARunThatDidNotEnd) {
  Findings failed;
  failed.judgement.add(Grade::do_not_use, "failed");
  const YAML::Node json = YAML::Load(json_report(failed));
  EXPECT_EQ(json["verdict"].as<std::string>(), "do not use");
  EXPECT_TRUE(json["pose"].IsNull());
  EXPECT_THAT(summary_text(failed), testing::StartsWith("verdict: do not use\n  - failed\n"));
}

TEST(JsonReport, WritesNullForNotANumberAndAnyName) {
  Findings failed;
  failed.judgement.add(Grade::do_not_use, "a\"b\\c\n\xFF");
  failed.assessments.emplace_back().uncertainty.design_effect = std::nan("");
  const YAML::Node json = YAML::Load(json_report(failed));
  EXPECT_EQ(json["reasons"][0].as<std::string>(), "a\"b\\c\n\xEF\xBF\xBD");
  EXPECT_TRUE(json["design_effect"].IsNull());
}

TEST(Summary, BeginsWithTheVerdictAndShowsDistancesAndDeviations) {
  const std::string text = summary_text(findings());
  EXPECT_THAT(text, testing::StartsWith("verdict: use with care\n  - few \"samples\"\n"));
  EXPECT_THAT(text, HasSubstr("Robot 'arm', 2 samples, 1 left out"));
  EXPECT_THAT(text, HasSubstr("10.000   1.000     2.100  4.000  1.100        2.000"));
  EXPECT_THAT(text, testing::ContainsRegex("elbow +0.000 +5.730 +0.573 +deg +0.1 +0\n"));
  EXPECT_THAT(text, HasSubstr("not determined"));
  EXPECT_THAT(text, HasSubstr("not significant"));
  EXPECT_THAT(text, HasSubstr("Pose of 'hand' in 'camera': +- 0.5 mm"));
  EXPECT_THAT(text, HasSubstr("--hold camera_z_offset"));
  EXPECT_THAT(text, HasSubstr("samples.yaml:40 (sample 3): error block 'hand_eye': feature 2 is "
                              "48 mm off, all others at most 3 mm, 43.0 times the noise; does not "
                              "fit the others"));
  EXPECT_THAT(text, HasSubstr("samples.yaml:20 (sample 2): --exclude; left out"));
  EXPECT_THAT(text, HasSubstr("3 parameters, 30 residuals"));
}

TEST(Summary, ShowsPosesThatNobodyKnewApartAndRawValuesOnlyIfAsked) {
  Findings all = findings();
  all.result.table.add({.name = "board_x", .unit = "m", .initial = 0.0, .value = 1.25});
  all.result.calibrated.push_back(3);
  all.result.steps[0].starts.frames = {"board"};
  const std::string text = findings_text(all);
  EXPECT_THAT(text, testing::ContainsRegex("elbow +0.000 +5.730 +0.573 +deg\n"));
  EXPECT_THAT(text, testing::ContainsRegex("Poses that were not known.*\n.*\n +board_x +- +1250"));
}

TEST(Summary, HasTheResultInOneLine) {
  EXPECT_EQ(findings_line(findings()),
            "use with care · hand_eye 1 mm (held out 2.1 mm) · 1 of 3 samples left out");
}

ProgramCall called(const std::string& output = "out") {
  return {{"kinecal", "calibrate", "--output", output},
          {"--urdf", "r.urdf", "--config", "c.yaml", "--samples", "s"},
          output};
}

TEST(NextStep, AnswersTheVerdictWithACommand) {
  Findings all = findings();
  all.call = called();
  EXPECT_EQ(next_step(all),
            "hold what these samples do not determine:\n"
            "  kinecal calibrate --output out --hold camera_z_offset --force");
  all.assessments[0].observability.hold = {};
  EXPECT_EQ(next_step(all),
            "see where residuals are large:\n"
            "  kinecal calibrate --output out --report report.html --force");
  all.judgement.remedies = {{Remedy::Kind::record}};
  EXPECT_EQ(next_step(all),
            "record more poses; which:\n  kinecal plan --urdf r.urdf --config c.yaml --samples s");
  all.judgement.add_causes(Grade::use_with_care, {"an eccentric encoder"});
  EXPECT_THAT(next_step(all), HasSubstr("mend the cause"));
  all.judgement = {};
  all.judgement.add(Grade::use_with_care, "prior 'p' contradicts the samples",
                    {Remedy::Kind::mend, "loosen or remove prior 'p'"});
  all.judgement.add(Grade::use_with_care, "few samples", {Remedy::Kind::record});
  EXPECT_EQ(next_step(all), "loosen or remove prior 'p', and calibrate again");
  all.judgement.add(Grade::do_not_use, "fewer samples", {Remedy::Kind::record});
  EXPECT_THAT(next_step(all), HasSubstr("record more poses"));
  all.judgement = {};
  EXPECT_THAT(next_step(all), HasSubstr("use out/calibrated.urdf"));
  EXPECT_THAT(next_step(all), HasSubstr("\n  kinecal verify out NEW_SAMPLES"));
  all.driver_file = "base_calibration.yaml";
  EXPECT_EQ(next_step(all),
            "use out/base_calibration.yaml, and verify it with a new recording:\n"
            "  kinecal verify out NEW_SAMPLES");
}

/// The words of the command that next_step() gives.
std::vector<std::string> pasted(const Findings& all) {
  const std::string step = next_step(all);
  const test::PastedCommand command = test::paste(step.substr(step.find("\n  ") + 3));
  EXPECT_FALSE(command.did_more) << step;
  return command.words;
}

TEST(NextStep, GivesNamesAndFoldersAsWordsWhateverTheyAre) {
  for (const std::string& name : test::kHostileNames) {
    Findings all = findings();
    all.call = called(name);
    std::vector<int>& hold = all.assessments[0].observability.hold;
    hold = {all.result.table.add({.name = name + " x"})};
    // A folder of this name looks like the option, which is not given twice.
    const std::string force = name == "--force" ? "calibrate" : "--force";
    EXPECT_THAT(
        pasted(all),
        testing::IsSupersetOf(
            {name, (name.starts_with("-") ? "--hold=" : "") + list_entry(name) + " x", force}));
    EXPECT_THAT(observability_text("s", all.assessments[0].observability, all.result.table),
                HasSubstr(": " + ShellCommand().add_names("--hold", {name + " x"}).str() + "\n"));
    all.judgement = {};
    EXPECT_THAT(pasted(all),
                testing::ElementsAre("kinecal", "verify", shell_file(name), "NEW_SAMPLES"));
  }
}

TEST(NextStep, HoldsAFrameByItsName) {
  Findings all = findings();
  std::vector<int>& hold = all.assessments[0].observability.hold;
  hold.clear();
  for (const char* axis : {"x", "y", "z", "a", "b", "c"}) {
    hold.push_back(all.result.table.size());
    all.result.table.add({.name = std::string("mount_") + axis});
  }
  hold.push_back(0);
  EXPECT_EQ(next_step(all), "hold what these samples do not determine:\n  mount elbow");
}

TEST(NextStep, LetsIdentifySearchWhereMuchIsToBeHad) {
  Findings all = findings();
  all.call = called();
  all.helps_leave = 0.6;
  EXPECT_THAT(next_step(all), HasSubstr("hold what"));
  all.helps_leave = 0.1;
  EXPECT_EQ(next_step(all),
            "find out what else is wrong:\n"
            "  kinecal identify --urdf r.urdf --config c.yaml --samples s");
}

/// Where it began is no guess.
TEST(NextStep, DoesNotHoldWhatNobodyKnew) {
  Findings all = findings();
  all.result.steps[0].starts.frames = {"board"};
  std::vector<int> axes;
  for (const char* axis : {"x", "y", "z"}) {
    axes.push_back(all.result.table.size());
    all.result.table.add({.name = std::string("board_") + axis});
  }
  all.assessments[0].observability.hold = {};
  all.assessments[0].weak.hold = {axes[0]};
  EXPECT_EQ(next_step(all), "record more poses");
  all.assessments[0].weak.hold = {axes[0], 0};
  EXPECT_EQ(next_step(all), "hold what these samples hardly determine:\n  elbow");
  all.assessments[0].weak.hold = {};
  all.assessments[0].observability.hold = axes;
  EXPECT_THAT(next_step(all), HasSubstr("see where residuals are large"));
  all.assessments[0].observability.hold = {axes[2]};  // an axis may be chosen freely
  EXPECT_EQ(next_step(all), "hold what these samples do not determine:\n  board_z");
}

TEST(TextReport, SaysWhatSolvingTook) {
  CalibrationResult r = findings().result;
  r.steps[0].samples = 100;
  r.steps[0].evaluations = 12;
  r.steps.push_back(r.steps[0]);  // both steps: 10 iterations, 2400 samples in 2 ms
  const std::string set(instruction_set());
  EXPECT_EQ(solving_text(r),
            "solving 0.0020 s (10 iterations, 1.2 million samples a second, " + set + ")");
  r.steps[1].form = CostForm::stacked;
  EXPECT_THAT(solving_text(r), HasSubstr(set + ", stacked cost)"));
  EXPECT_THAT(solving_text({}), HasSubstr("solving 0.0000 s (0 iterations, x86-64"));
}

TEST(TextReport, NamesUnobservableCombinationsAndWhatToHold) {
  const auto table = findings().result.table;
  EXPECT_EQ(observability_text("one", {2, 1.0, {}, {}}, table), "");
  const std::string text = observability_text("one", {1, 2.5, {{{0, 1.0}, {1, -0.5}}}, {1}}, table);
  EXPECT_THAT(text, HasSubstr("1 of 2 parameters cannot be determined from these samples"));
  EXPECT_THAT(text, HasSubstr("+1 elbow -0.5 camera_z_offset"));
  EXPECT_THAT(text, HasSubstr("--hold camera_z_offset"));
}

TEST(Statistics, AreThoseOfTheDefinition) {
  const Statistics s = statistics_of({3.0, 1.0, 2.0, 10.0});
  EXPECT_DOUBLE_EQ(s.rms, std::sqrt((9 + 1 + 4 + 100) / 4.0));
  EXPECT_DOUBLE_EQ(s.mean, 4.0);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.max, 10.0);
  EXPECT_EQ(statistics_of({}).max, 0.0);
}

}  // namespace
}  // namespace kinecal
