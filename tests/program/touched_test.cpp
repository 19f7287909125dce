// An arm and nothing to measure with, as its user meets it: from a table of joints to a URDF, and what is refused.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/tools/init/determined_offsets.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"
#include "support/two_arms.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// The joints of a robot in poses in which it touches something, as a table: its zeros are wrong, its encoders noisy.
struct TouchTable {
  std::string text;                     ///< with a header; radians
  std::map<std::string, double> wrong;  ///< by joint: true minus recorded position, radians

  /// @param sockets  names of those touched in turn; empty: no such column
  TouchTable(const Robot& robot, const MeasuredTarget& touched,
             const std::vector<std::string>& sockets = {}) {
    std::mt19937 random(3);
    std::normal_distribution<double> jitter(0.0, 2e-4);
    const TouchingPoses poses = touching_poses(robot, touched, 60, 1);
    text = sockets.empty() ? "" : "socket,";
    for (const auto& [joint, position] : poses.positions.front()) {
      wrong[joint] = std::uniform_real_distribution<double>(-0.02, 0.02)(random);
      text += (wrong.size() > 1 ? "," : "") + joint;
    }
    for (std::size_t i = 0; i < poses.positions.size(); ++i) {
      text += sockets.empty() ? "\n" : "\n" + sockets[i % sockets.size()] + ",";
      std::size_t column = 0;
      for (const auto& [joint, position] : poses.positions[i]) {
        text += fmt::format("{}{:.9f}", column++ > 0 ? "," : "",
                            position - wrong.at(joint) + jitter(random));
      }
    }
    text += "\n";
  }
};

/// A tip of a UR5e in one of two sockets, 50 mm apart in a base.
MeasuredTarget two_sockets() {
  MeasuredTarget touched{"base_link", "tool0", "base_link", "tip", true, "sockets"};
  touched.contact = Contact::point;
  touched.layout = {Vector3<double>::Zero(), {0.05, 0.0, 0.0}};
  return touched;
}

class Touched : public test::ProgramTest {
 protected:
  Touched() {
    const fs::path examples = fs::path(test::source_folder()) / "examples";
    fs::copy(examples / "csv/cone.csv", folder_);
    fs::copy(examples / "robots/ur5e/ur5e.urdf", folder_);
  }

  /// What a calibration of a table says, after init and convert.
  /// @param init  further options of init
  [[nodiscard]] Outcome calibrated(const std::string& urdf, const std::string& table,
                                   const std::string& init) {
    const Outcome made = kinecal("init --urdf " + urdf + " --force --from " + table + " " + init);
    EXPECT_EQ(made.code, 0) << made.out << made.err;
    EXPECT_EQ(kinecal("convert " + table + " samples.yaml --columns columns.yaml --force").code, 0);
    return kinecal("calibrate --urdf " + urdf +
                   " --config calibrate.yaml --samples samples.yaml --output out --report r.json "
                   "--force");
  }

  /// Expects that zeros of a report are those that are wrong, within their ±.
  /// @returns  how many it has
  [[nodiscard]] std::size_t expect_zeros(const std::map<std::string, double>& wrong) {
    std::size_t found = 0;
    const auto report = nlohmann::json::parse(read("r.json"));
    for (const auto& parameter : report.at("parameters")) {
      const auto truth = wrong.find(parameter.at("name").get<std::string>());
      if (truth == wrong.end() || !parameter.at("sigma").is_number()) continue;
      ++found;
      EXPECT_NEAR(parameter.at("value").get<double>(), truth->second,
                  5.0 * parameter.at("sigma").get<double>())
          << truth->first;
    }
    return found;
  }
};

TEST_F(Touched, TheTableOfAConeCalibratesAsTheManualSays) {
  const Outcome made = kinecal("init --urdf ur5e.urdf --from cone.csv --target point --arm tool0");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("from the samples: target point; arm tool0"));
  ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml").code, 0);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out "
      "--report r.json");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, HasSubstr("verdict: good"));
  constexpr double kDegree = 0.017453292519943295;
  const std::map<std::string, double> truth = {{"shoulder_lift_joint", 0.31 * kDegree},
                                               {"elbow_joint", -0.42 * kDegree},
                                               {"wrist_1_joint", 0.37 * kDegree},
                                               {"wrist_2_joint", -0.28 * kDegree},
                                               {"tip_x", 0.012},
                                               {"tip_y", -0.008},
                                               {"tip_z", 0.145}};
  std::size_t found = 0;
  const auto report = nlohmann::json::parse(read("r.json"));
  for (const auto& parameter : report.at("parameters")) {
    const auto true_value = truth.find(parameter.at("name").get<std::string>());
    if (true_value == truth.end()) continue;
    ++found;
    EXPECT_NEAR(parameter.at("value").get<double>(), true_value->second,
                4.0 * parameter.at("sigma").get<double>())
        << true_value->first;
  }
  EXPECT_EQ(found, truth.size());
}

TEST_F(Touched, JointsAloneAskWhatTheTipTouched) {
  const Outcome asked = kinecal("init --urdf ur5e.urdf --from cone.csv");
  EXPECT_EQ(asked.code, 1);
  EXPECT_THAT(asked.err, AllOf(HasSubstr("cone.csv: no three columns are called x, y, z"),
                               HasSubstr("--target with one of point, tool")));
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Touched, ALengthGoesWithWhatHasOne) {
  for (const auto& [words, says] : std::map<std::string, std::string>{
           {"--target point --length 0.05", "point has no length"},
           {"--target bar --length -1", "-1 is no length in metres"},
           {"--target sockets", "no column says which socket"},
           {"--target sockets --length 0.05", "no column is called 'socket'"}}) {
    fs::remove(folder_ / "columns.yaml");
    const Outcome refused = kinecal("init --urdf ur5e.urdf --from cone.csv " + words);
    EXPECT_EQ(refused.code, 1) << words;
    EXPECT_THAT(refused.err, HasSubstr(says)) << words;
    EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml")) << words;
  }
}

/// The tool's centre point as pendants find it, from four poses: the joints stay.
TEST_F(Touched, FourPosesGiveTheToolsCenterPoint) {
  const std::string table = read("cone.csv");
  std::size_t end = 0;
  for (int line = 0; line < 7; ++line) end = table.find('\n', end) + 1;
  write("cone.csv", table.substr(0, end));
  ASSERT_EQ(kinecal("init --urdf ur5e.urdf --from cone.csv --target tool --arm tool0").code, 0);
  EXPECT_THAT(read("calibrate.yaml"), Not(HasSubstr("free_params:")));
  ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml").code, 0);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --output out");
  EXPECT_THAT(done.out, HasSubstr("tip_z"));
}

/// How many poses it takes, before anybody has taken one; the tip is where the URDF has it.
TEST_F(Touched, PlansPosesInWhichTheTipTouches) {
  for (const auto& [target, tip] : std::map<std::string, std::string>{
           {"point", "tip"}, {"plane", "tip"}, {"distance", "gauge"}}) {
    ASSERT_EQ(kinecal("init --urdf ur5e.urdf --arm tool0 --force --target " + target).code, 0);
    const Outcome planned = kinecal("plan --urdf ur5e.urdf --config calibrate.yaml --accuracy '" +
                                    tip + " 1 mm' -o poses.yaml --force");
    EXPECT_EQ(planned.code, 0) << target << planned.out << planned.err;
    EXPECT_TRUE(fs::exists(folder_ / "poses.yaml")) << planned.out;
  }
}

/// A board in both hands of a robot: a table of the joints of both arms, and nothing else.
TEST_F(Touched, ABoardInBothHandsCalibratesBothArms) {
  write("two_arms.urdf", test::TwoArms::urdf(7));
  const Robot robot = parse_urdf(test::TwoArms::urdf(7), "two_arms.urdf");
  MeasuredTarget grip{"torso", "left_hand", "right_hand"};
  grip.sensor_frame = "grip";
  grip.contact = Contact::grip;
  const TouchTable table(robot, grip);
  write("grip.csv", table.text);
  const Outcome done = calibrated("two_arms.urdf", "grip.csv",
                                  "--target grip --arm left_hand --touched-link right_hand");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(read("calibrate.yaml"), HasSubstr("Left out: left_joint_6"));
  EXPECT_EQ(expect_zeros(table.wrong), 12u);
  const Outcome chosen = kinecal(
      "select-poses --urdf two_arms.urdf --config calibrate.yaml --samples samples.yaml --count 20 "
      "-o few.yaml");
  EXPECT_EQ(chosen.code, 0) << chosen.out << chosen.err;
  // The other hand of two is the one that is meant.
  EXPECT_EQ(kinecal("init --urdf two_arms.urdf --force --from grip.csv --target grip").code, 0);
  ASSERT_EQ(kinecal("init --urdf two_arms.urdf --force --target grip --arm left_hand "
                    "--touched-link right_hand")
                .code,
            0);
  EXPECT_THAT(read("capture.yaml"), AllOf(HasSubstr("TouchFinder"), HasSubstr("has_direction")));
}

TEST_F(Touched, AGripNeedsTwoHands) {
  const Outcome one = kinecal("init --urdf ur5e.urdf --from cone.csv --target grip");
  EXPECT_EQ(one.code, 1);
  EXPECT_THAT(one.err, HasSubstr("--touched-link"));
  write("two_arms.urdf", test::TwoArms::urdf(7));
  const Outcome several =
      kinecal("init --urdf two_arms.urdf --target plane --arm left_hand,right_hand");
  EXPECT_EQ(several.code, 1);
  EXPECT_THAT(several.err, HasSubstr("--target grip"));
  const Outcome sockets =
      kinecal("init --urdf two_arms.urdf --target sockets --arm left_hand,right_hand");
  EXPECT_EQ(sockets.code, 0) << sockets.err;
  EXPECT_THAT(read("capture.yaml"),
              AllOf(HasSubstr("socket_1_left_hand:"), HasSubstr("socket_2_right_hand:")));
}

TEST_F(Touched, AKnownPlaceOnTheBodyIsHeld) {
  MeasuredTarget bore{"base_link", "tool0", "base_link", "tip", true};
  bore.contact = Contact::point;
  bore.layout = {Vector3<double>(-0.2, 0.3, 0.15)};
  const Robot robot = read_urdf((folder_ / "ur5e.urdf").string());
  const TouchTable table(robot, bore);
  write("bore.csv", table.text);
  const Outcome done = calibrated("ur5e.urdf", "bore.csv",
                                  "--target point --arm tool0 --base base_link --touched-link "
                                  "base_link --touched-at -0.2,0.3,0.15");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(read("calibrate.yaml"),
              AllOf(HasSubstr("fixed_frames:"), HasSubstr("x: -0.2, y: 0.3")));
  EXPECT_EQ(expect_zeros(table.wrong), 5u);  // the first, too
  for (const auto& [words, says] :
       std::map<std::string, std::string>{{"plane --touched-at 0,0,0", "plane is not at one point"},
                                          {"point --touched-at 0,0,2000", "is no place in metres"},
                                          {"point --touched-at 0,0,8", "hardly reaches this place"},
                                          {"sockets --touched-at 0,0,0", "sockets.csv"}}) {
    const Outcome refused = kinecal("init --urdf ur5e.urdf --force --arm tool0 --target " + words);
    EXPECT_EQ(refused.code, 1) << words;
    EXPECT_THAT(refused.err, HasSubstr(says)) << words;
  }
}

/// A ball in the wrong socket by its column, and one that did not seat: each is named by its line, the others are used.
TEST_F(Touched, AWrongSocketAndABallThatDidNotSeatAreNamed) {
  const Robot robot = read_urdf((folder_ / "ur5e.urdf").string());
  const TouchTable table(robot, two_sockets(), {"A", "B"});
  std::vector<std::string> lines;
  std::istringstream in(table.text);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  lines[11].front() = lines[11].front() == 'A' ? 'B' : 'A';
  const std::size_t last = lines[23].rfind(',', lines[23].rfind(',') - 1);
  const double position = std::stod(lines[23].substr(last + 1));
  lines[23] = lines[23].substr(0, last + 1) + fmt::format("{:.9f}", position + 0.05) +
              lines[23].substr(lines[23].rfind(','));
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  write("sockets.txt", text);
  const Outcome done = calibrated("ur5e.urdf", "sockets.txt", "--length 0.05 --arm tool0");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  EXPECT_THAT(done.out, AllOf(HasSubstr("(sample 11)"), HasSubstr("(sample 23)"),
                              HasSubstr("samples.yaml:"), HasSubstr("2 of 60 samples left out")));
  (void)expect_zeros(table.wrong);
}

/// Without a length, one factor of all lengths is free: no calibration may set it.
TEST_F(Touched, ALengthThatTheScaleEatsIsSaid) {
  ASSERT_EQ(kinecal("init --urdf ur5e.urdf --from cone.csv --target point --arm tool0").code, 0);
  ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml").code, 0);
  std::string config = read("calibrate.yaml");
  std::string frames;
  for (const char* joint :
       {"shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"}) {
    frames += fmt::format(
        " - {{name: {}, x: true, y: true, z: true, roll: false, pitch: false, "
        "yaw: false}}\n",
        joint);
  }
  const std::string key = "free_frames:\n";
  config.insert(config.find(key) + key.size(), frames);
  write("all.yaml", config);
  const Outcome done = kinecal(
      "calibrate --urdf ur5e.urdf --config all.yaml --samples samples.yaml --output out --report "
      "r.json");
  std::cout << done.out << done.err;
  EXPECT_THAT(done.out + done.err, HasSubstr("not determine"));
}

/// Another target than that of the columns.yaml which is there.
TEST_F(Touched, ColumnsOfAnotherTargetAreNotUsed) {
  const std::string init =
      "init --urdf ur5e.urdf --from cone.csv --arm tool0 -o new.yaml --target ";
  ASSERT_EQ(kinecal(init + "point").code, 0);
  fs::remove(folder_ / "new.yaml");
  const Outcome other = kinecal(init + "plane");
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err, AllOf(HasSubstr("columns.yaml: an earlier 'kinecal init' wrote it for "
                                         "target point, and --target is plane"),
                               HasSubstr("--force")));
  EXPECT_EQ(kinecal(init + "plane --force").code, 0);
  fs::remove(folder_ / "new.yaml");
  EXPECT_EQ(kinecal(init + "plane").code, 0);
}

/// Recorded tables of each target, and poses that nobody has taken yet.
TEST_F(Touched, PosesAreSelectedAndPlannedForEachTarget) {
  for (const std::string target :
       {"point", "tool", "plane", "line", "sphere", "bar --length 0.3"}) {
    ASSERT_EQ(
        kinecal("init --urdf ur5e.urdf --force --from cone.csv --arm tool0 --target " + target)
            .code,
        0);
    ASSERT_EQ(kinecal("convert cone.csv samples.yaml --columns columns.yaml --force").code, 0);
    const Outcome chosen = kinecal(
        "select-poses --urdf ur5e.urdf --config calibrate.yaml --samples samples.yaml --count 12 "
        "-o few.yaml --force");
    EXPECT_EQ(chosen.code, 0) << target << chosen.out << chosen.err;
    EXPECT_THAT(chosen.out, HasSubstr("12 of 40 poses selected")) << target;
  }
  write("two_arms.urdf", test::TwoArms::urdf(7));
  const std::string hands = "two_arms.urdf --arm left_hand --touched-link right_hand";
  for (const auto& [init, tip] : std::map<std::string, std::string>{
           {"ur5e.urdf --arm tool0 --target sockets", "tip"},
           {"ur5e.urdf --arm tool0 --target sockets --length 0.05", "tip"},
           {"ur5e.urdf --arm tool0 --target line", "tip"},
           {"ur5e.urdf --arm tool0 --target sphere", "tip"},
           {"ur5e.urdf --arm tool0 --target bar --length 0.3", "tip"},
           {"ur5e.urdf --arm tool0 --target point --touched-at 0.3,0.2,0.1", "tip"},
           {hands + " --target point", "tip"},
           {"two_arms.urdf --arm left_hand,right_hand --target sockets", "left_hand_tip"},
           {hands + " --target grip", "left_hand"}}) {
    const std::string urdf = init.substr(0, init.find(' '));
    ASSERT_EQ(kinecal("init --force --urdf " + init).code, 0) << init;
    const Outcome planned =
        kinecal("plan --urdf " + urdf + " --config calibrate.yaml --accuracy '" + tip +
                " 1 mm' -o poses.yaml --force");
    EXPECT_EQ(planned.code, 0) << init << planned.out << planned.err;
  }
}

/// A Panda with a ball in two sockets 50 mm apart, as a table with joints and sockets; two regions held out.
TEST_F(Touched, SocketsAndALengthFindTheGeometryOfThePanda) {
  KINECAL_NEEDS_DATA("mukca_panda");
  const std::string data = test::data_folder().string() + "/mukca_panda/";
  Diagnostics diagnostics;
  std::string table = "socket";
  for (int i = 1; i <= 7; ++i) table += fmt::format(",panda_joint{}", i);
  for (const Sample& sample : read_samples(data + "panda_6/front.yaml", diagnostics)) {
    table += sample.observations.at(1).features.at(0).point.x() > 0.01 ? "\nB" : "\nA";
    for (int i = 1; i <= 7; ++i) {
      table += fmt::format(",{:.17g}", *sample.position(fmt::format("panda_joint{}", i)));
    }
  }
  write("front.csv", table + "\n");
  const std::string urdf = "--urdf " + data + "panda.urdf ";
  const Outcome made =
      kinecal("init " + urdf + "--from front.csv --length 0.05 --target-frame ball_link");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("from the samples: target sockets"));
  ASSERT_EQ(kinecal("convert front.csv samples.yaml --columns columns.yaml").code, 0);
  const std::string files = urdf + "--samples samples.yaml ";
  ASSERT_EQ(kinecal("identify " + files + "--config calibrate.yaml --geometry-only").code, 0);
  const Outcome done =
      kinecal("calibrate " + files + "--config identified.yaml --offsets origin --output out");
  ASSERT_EQ(done.code, 0) << done.out << done.err;
  for (const auto& [region, most] :
       std::map<std::string, double>{{"left", 0.265}, {"right", 0.307}}) {
    const Outcome held_out =
        kinecal("calibrate --urdf out/calibrated.urdf --config " + data + "panda_6/" + region +
                "_fixture.yaml --samples " + data + "panda_6/" + region + ".yaml --output " +
                region + " --report " + region + ".json");
    ASSERT_EQ(held_out.code, 0) << held_out.err;
    const auto report = nlohmann::json::parse(read(region + ".json"));
    const auto& step = report.at("steps").at(0);
    const double rms = 1e3 * std::sqrt(6.0 * step.at("final_cost").get<double>() /
                                       step.at("num_residuals").get<double>());
    std::cout << fmt::format("{} held out: {:.3f} mm\n", region, rms);
    EXPECT_LE(rms, most) << region;
  }
}

}  // namespace
}  // namespace kinecal
