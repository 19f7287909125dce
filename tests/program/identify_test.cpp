// kinecal identify, and what goes with it: the report of a search, calibrate with a configuration that leaves open what is
// free, samples of another robot, and poses that decide between two explanations.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class IdentifyProgram : public test::TrackerExampleTest {
 protected:
  IdentifyProgram() {
    EXPECT_EQ(kinecal("convert tracker.csv samples.yaml --columns columns.yaml").code, 0);
  }
  /// Writes calibrate.yaml without what it frees.
  /// @param with  in place of it
  void write_open_config(const std::string& with = "") const {
    ASSERT_EQ(kinecal("init --urdf ur5e.urdf --target tracker --arm tool0").code, 0);
    const std::string text = read("calibrate.yaml");
    const std::size_t begin = text.find("\nfree_params:");
    const std::size_t end = text.find("\nerror_blocks:");
    ASSERT_LT(begin, end);
    write("calibrate.yaml", text.substr(0, begin) + "\n" + with + text.substr(end));
  }
};

const std::string kFiles = "--urdf ur5e.urdf --samples samples.yaml ";

TEST_F(IdentifyProgram, AQuarterTurnIsInTheReportOfACalibrationThatHoldsIt) {
  std::string table = read("samples.yaml");
  const std::regex wrist(R"((position: \[[^,\]]*,[^,\]]*,[^,\]]*,[^,\]]*, )([^,\]]*))");
  std::string turned;
  std::smatch match;
  while (std::regex_search(table, match, wrist)) {  // the fifth joint
    turned += match.prefix().str() + match[1].str() +
              std::to_string(std::stod(match[2].str()) - 1.570796326794897);
    table = match.suffix();
  }
  write("samples.yaml", turned + table);
  ASSERT_EQ(kinecal("identify " + kFiles).code, 0);
  const Outcome done =
      kinecal("calibrate " + kFiles + "--config identified.yaml --output out --hold wrist_2_joint");
  const std::regex held("wrist_2_joint +9[0-9.]+ +9[0-9.]+ +- +deg +held");
  EXPECT_TRUE(std::regex_search(done.out, held)) << done.out << done.err;
}

TEST_F(IdentifyProgram, WritesTheSearchIntoItsReports) {
  const Outcome found = kinecal("identify " + kFiles + "--report r.html --report r.json");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr(" · identified.yaml · r.html · r.json\n"));
  const std::string page = read("r.html"), json = read("r.json");
  EXPECT_THAT(page, AllOf(HasSubstr("<section id=\"search\">"), HasSubstr("data-chart=\"search\""),
                          HasSubstr("href=\"#search\"")));
  EXPECT_THAT(json, AllOf(HasSubstr("\"search\": ["), HasSubstr("\"held_out_error\": "),
                          HasSubstr("\"freed\": \"wrist_1_joint\"")));
}

TEST_F(IdentifyProgram, ReportsAreAsTheirSchemaSays) {
  if (std::system("python3 -c 'import jsonschema' 2> /dev/null") != 0) {
    GTEST_SKIP() << "there is no python3-jsonschema";
  }
  ASSERT_EQ(kinecal("calibrate " + kFiles + "--output out").code, 0);
  const fs::path source = test::source_folder();
  const Outcome valid = run("python3 " + (source / "tests/program/validate.py").string() + " " +
                            (source / "include/kinecal/report/schema").string() + " out");
  EXPECT_EQ(valid.code, 0) << valid.out << valid.err;
}

TEST_F(IdentifyProgram, CalibrateSearchesWhereTheConfigurationLeavesItOpen) {
  write_open_config();
  const Outcome found = kinecal("identify " + kFiles + "--config calibrate.yaml");
  ASSERT_EQ(found.code, 0) << found.err;
  const Outcome open = kinecal("calibrate " + kFiles + "--config calibrate.yaml --output out");
  EXPECT_EQ(open.code, 0) << open.err;
  EXPECT_THAT(open.err, HasSubstr("calibrate.yaml: nothing is free: what these samples support is "
                                  "searched for, as 'kinecal identify' does"));
  const std::string table = found.out.substr(0, found.out.find("\ngood"));
  EXPECT_THAT(open.out, HasSubstr(table)) << "the same table";
  EXPECT_EQ(read("out/config.yaml"), read("identified.yaml"));
  const Outcome none = kinecal("calibrate " + kFiles + "--dry-run");
  EXPECT_EQ(none.code, 0) << none.err;
  EXPECT_THAT(none.err, HasSubstr("there is no --config; the samples suggest one"));
  const Outcome quiet = kinecal("calibrate " + kFiles + "--dry-run --json");
  EXPECT_THAT(quiet.out, testing::StartsWith("{"));
}

TEST_F(IdentifyProgram, AnEmptyListIsAnErrorThatNamesIdentify) {
  write_open_config("free_params: []\n");
  const Outcome refused = kinecal("calibrate " + kFiles + "--config calibrate.yaml --output out");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err,
              HasSubstr("nothing is free; name parameters under 'free_params' or frames "
                        "under 'free_frames', or let 'kinecal identify' find them"));
  EXPECT_EQ(kinecal("identify " + kFiles + "--config calibrate.yaml").code, 0);
}

TEST_F(IdentifyProgram, HoldsWhatItIsTold) {
  const Outcome held = kinecal("identify " + kFiles + "--hold wrist_1_joint");
  EXPECT_THAT(held.out, Not(HasSubstr("\n  wrist_1_joint  ")));
  const Outcome unknown = kinecal("identify " + kFiles + "--hold wrist_1_jiont --force");
  EXPECT_EQ(unknown.code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("--hold wrist_1_jiont: is not a candidate of the search; did "
                                     "you mean 'wrist_1_joint'?"));
}

TEST_F(IdentifyProgram, HoldsAJointAsTheConfigurationItWrites) {
  const Outcome held = kinecal("identify " + kFiles + "--hold elbow_joint");
  EXPECT_THAT(held.out, Not(HasSubstr("\n  elbow_joint_")));
  EXPECT_THAT(read("identified.yaml"), Not(HasSubstr("name: elbow_joint,")));
  const Outcome pose = kinecal("identify " + kFiles + "--hold tracker_frame --force");
  EXPECT_EQ(pose.code, 1);
  EXPECT_THAT(pose.err, HasSubstr("--hold tracker_frame: nothing says where it is"));
}

TEST_F(IdentifyProgram, NamesAMistakeInSamples) {
  std::string urdf = read("ur5e.urdf");  // wrist_1 counts the other way
  const std::size_t joint = urdf.find("<joint name=\"wrist_1_joint\"");
  const std::size_t axis = urdf.find("<axis xyz=\"0 0 1\"", joint);
  ASSERT_LT(joint, axis);
  write("turned.urdf", urdf.replace(axis, 17, "<axis xyz=\"0 0 -1\""));
  const Outcome found = kinecal("identify --urdf turned.urdf --samples samples.yaml");
  EXPECT_EQ(found.code, 2);
  EXPECT_THAT(found.out, HasSubstr("likely cause: with the positions of 'wrist_1_joint' negated"));
}

TEST_F(IdentifyProgram, SelectPosesKeepsItsSamples) {
  ASSERT_EQ(kinecal("identify " + kFiles).code, 0);
  const std::string before = read("samples.yaml");
  const Outcome refused = kinecal("select-poses " + kFiles +
                                  "--config identified.yaml --count 10 -o samples.yaml --force");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("samples.yaml: would replace an input"));
  EXPECT_EQ(read("samples.yaml"), before);
}

TEST_F(IdentifyProgram, SaysThatSamplesSupportNothing) {
  ASSERT_EQ(kinecal("calibrate " + kFiles + "--offsets origin --output out").code, 0);
  const std::string right = "--urdf out/calibrated.urdf --samples samples.yaml ";
  const Outcome poses = kinecal("identify " + right);
  EXPECT_EQ(poses.code, 0) << poses.err;
  EXPECT_THAT(poses.out, HasSubstr("these samples support none of them: only unknown poses are "
                                   "freed"));
  const Outcome nothing =
      kinecal("identify " + right + "--config out/config.yaml --hold tracker_frame,smr -o no.yaml");
  EXPECT_EQ(nothing.code, 2) << nothing.err;
  EXPECT_THAT(nothing.out, AllOf(HasSubstr("these samples support none of them: nothing is freed"),
                                 HasSubstr("no.yaml was not written: no pose is unknown")));
  EXPECT_FALSE(fs::exists(folder_ / "no.yaml"));
}

TEST_F(IdentifyProgram, RefusesSamplesOfAnotherRobot) {
  const std::string own = read("ur5e.urdf");
  for (const auto& [length, sentence] :
       {std::pair("-0.612", "whatever is freed: the URDF is that of another robot"),
        std::pair("-0.465", "of another version of it: these samples change elbow_joint_x by")}) {
    const std::string urdf = std::regex_replace(own, std::regex("xyz=\"-0\\.425[0-9]* "),
                                                std::string("xyz=\"") + length + " ");
    ASSERT_NE(urdf, own);
    write("other.urdf", urdf);
    const Outcome refused = kinecal("identify --urdf other.urdf --samples samples.yaml");
    EXPECT_EQ(refused.code, 2) << refused.out;
    EXPECT_THAT(refused.out, AllOf(HasSubstr(sentence), HasSubstr("do not use"),
                                   HasSubstr("identified.yaml was not written")));
    EXPECT_EQ(kinecal("calibrate --urdf other.urdf --samples samples.yaml --dry-run --quiet").code,
              2);
  }
}

TEST_F(IdentifyProgram, NamesPosesThatDecideBetweenTwoExplanations) {
  ASSERT_EQ(kinecal("identify " + kFiles).code, 0);
  const Outcome chosen = kinecal("select-poses " + kFiles +
                                 "--config identified.yaml --tell-apart "
                                 "shoulder_lift_joint,shoulder_lift_joint_gear_ratio --count 10 "
                                 "-o poses.yaml");
  EXPECT_EQ(chosen.code, 0) << chosen.err;
  EXPECT_THAT(chosen.out, AllOf(HasSubstr("which tell 'shoulder_lift_joint' and "
                                          "'shoulder_lift_joint_gear_ratio' apart"),
                                HasSubstr("\n  correlation  ")));
  EXPECT_TRUE(fs::exists(folder_ / "poses.yaml"));
  const Outcome none = kinecal("select-poses " + kFiles +
                               "--config identified.yaml --tell-apart "
                               "elbow_joint_z,wrist_1_joint_z --count 10");
  EXPECT_EQ(none.code, 1);  // parallel axes
  EXPECT_THAT(none.err, HasSubstr("no pose tells 'elbow_joint_z' and 'wrist_1_joint_z' apart"));
}

TEST_F(IdentifyProgram, PlansHowManyPosesDecideBetweenTwoExplanations) {
  ASSERT_EQ(kinecal("identify " + kFiles).code, 0);
  const std::string call = "plan " + kFiles + "--config identified.yaml --tell-apart ";
  const Outcome planned = kinecal(
      call + "shoulder_lift_joint,shoulder_lift_joint_gear_ratio --candidates 50 -o poses.yaml");
  ASSERT_EQ(planned.code, 0) << planned.out << planned.err;
  const std::size_t end = planned.out.find(" tell 'shoulder_lift_joint' and "),
                    none = std::string::npos;
  if (planned.out.find("no more poses are needed") == none) {
    ASSERT_NE(end, none) << planned.out;
    EXPECT_THAT(planned.out, HasSubstr("By number of poses; random: "));
    EXPECT_TRUE(fs::exists(folder_ / "poses.yaml"));
  }
  EXPECT_THAT(kinecal(call + "elbow_joint_z,wrist_1_joint_z --candidates 50").err,
              HasSubstr("no pose tells 'elbow_joint_z' and 'wrist_1_joint_z' apart"));
  EXPECT_EQ(kinecal(call + "elbow_joint,elbow_joint_z --accuracy 'gripper 1 mm'").code, 1)
      << "an accuracy is not what decides";
}

}  // namespace
}  // namespace kinecal
