// kinecal simulate and kinecal capture: a simulated robot from poses to a calibration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/run_program.hpp"

namespace kinecal::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kProgram = KINECAL_PROGRAM;
const std::string kUrdf =
    std::string(KINECAL_SOURCE_DIR) + "/examples/mobile_manipulator/mobile_manipulator.urdf";

class CaptureProgram : public ProgramTest {
 protected:
  /// A robot with LEDs, its poses and configurations, in sim/.
  void simulate(int poses) {
    const Outcome made = run(kProgram + " simulate " + kUrdf + " --target leds --poses " +
                             std::to_string(poses) + " -o sim");
    ASSERT_EQ(made.code, 0) << made.err;
  }
  /// A session of that robot.
  [[nodiscard]] Outcome capture(const std::string& options) const {
    return run(kProgram +
               " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
               "--robot simulated:sim/scene.yaml -o samples.yaml " +
               options);
  }
  /// Samples in samples.yaml.
  [[nodiscard]] int samples() const {
    std::ifstream file(folder_ / "samples.yaml");
    int count = 0;
    for (std::string line; std::getline(file, line);) count += line == "---" ? 1 : 0;
    return count;
  }
};

TEST_F(CaptureProgram, CapturesUntilAnAccuracyIsReachedAndCalibrates) {
  simulate(40);
  const Outcome session = capture(
      "--calibrate sim/calibrate.yaml --until 'gripper 5 mm' --result calibrated "
      "--contact-sheet views.png");
  EXPECT_EQ(session.code, 0) << session.out << session.err;
  EXPECT_THAT(session.out,
              AllOf(HasSubstr("led_finder: 4 features"), HasSubstr("'gripper 5 mm' is reached"),
                    HasSubstr("next, move"), HasSubstr("truth: '"), HasSubstr("by the URDF, "),
                    ContainsRegex("pose 1 of 40: .*; at most [0-9]+ min left\n")));
  EXPECT_LT(samples(), 40);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "views.png"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "calibrated/calibrated.urdf"));
}

TEST_F(CaptureProgram, ResumesWhereItEnded) {
  simulate(6);
  // The robot is lost after a while: a fault of the scene.
  std::ofstream(folder_ / "sim/lost.yaml")
      << std::ifstream(folder_ / "sim/scene.yaml").rdbuf() << "faults: {connection_ends: 25}\n";
  const Outcome lost = run(kProgram +
                           " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                           "--robot simulated:sim/lost.yaml -o samples.yaml");
  EXPECT_EQ(lost.code, 1) << lost.out;
  EXPECT_THAT(lost.err, HasSubstr("--resume goes on from here"));
  const int before = samples();
  EXPECT_GT(before, 0);
  EXPECT_LT(before, 6);
  EXPECT_EQ(capture("").code, 1);  // the file is there
  const Outcome rest = capture("--resume");
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_THAT(rest.out, AllOf(HasSubstr("(" + std::to_string(before) + " from before)"),
                              ContainsRegex("pose 1 of [0-9]: .*; [0-9]+ s left\n"),
                              ContainsRegex("features\n")))
      << "nothing is left after the last pose";
  EXPECT_EQ(samples(), 6);
  EXPECT_THAT(capture("--resume").out, HasSubstr("6 samples of 0 poses"));
}

TEST_F(CaptureProgram, EndsWithADeadCamera) {
  simulate(5);
  std::ofstream(folder_ / "sim/blind.yaml")
      << std::ifstream(folder_ / "sim/scene.yaml").rdbuf() << "faults: {views_end: 20}\n";
  const Outcome blind =
      run(kProgram +
          " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
          "--robot simulated:sim/blind.yaml -o samples.yaml");
  EXPECT_EQ(blind.code, 1) << blind.out;
  EXPECT_THAT(blind.err, AllOf(HasSubstr("error: no images for 5 s"), HasSubstr("in two poses"),
                               HasSubstr("--resume goes on from here")));
  EXPECT_GT(samples(), 0);
  EXPECT_THAT(blind.out, Not(HasSubstr("pose 5 of 5")));
}

TEST_F(CaptureProgram, SaysWhatIsWrongBeforeTheRobotMoves) {
  simulate(3);
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                     "--robot fetch:8765 -o s.yaml")
          .err,
      HasSubstr("'fetch:8765' is not an address"));
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                     "--robot ws://127.0.0.1:1 -o s.yaml")
          .err,
      HasSubstr("127.0.0.1:1"));
  EXPECT_THAT(run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --robot pipe:false "
                             "-o s.yaml")
                  .err,
              HasSubstr("--poses is required, or --manual"));
  EXPECT_THAT(capture("--calibrate sim/calibrate.yaml --until '1 mm'").err,
              HasSubstr("'1 mm' is not an accuracy"));
  EXPECT_THAT(capture("--calibrate sim/calibrate.yaml --until 'grippr 1 mm'").err,
              HasSubstr("the robot has no link 'grippr'"));
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                     "--robot simulated:sim/scene.yaml -o s.txt")
          .err,
      HasSubstr("the name must end in .yaml, .bag or .mcap"));
  EXPECT_THAT(capture("--velocity nan").err, HasSubstr("--velocity"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "samples.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.yaml"));
}

TEST_F(CaptureProgram, ReplacesNoInputAndNoSecondOutput) {
  simulate(2);
  const std::string robot =
      " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
      "--robot simulated:sim/scene.yaml --force ";
  const auto text = [&](const std::string& name) {
    std::ostringstream all;
    all << std::ifstream(folder_ / name).rdbuf();
    return all.str();
  };
  for (const std::string file : {"sim/poses.yaml", "sim/robot.urdf", "sim/scene.yaml"}) {
    const std::string before = text(file);
    for (const std::string outputs : {"-o s.yaml --contact-sheet ", "-o "}) {
      if (outputs == "-o " && file.ends_with("urdf")) continue;  // no format of samples
      const Outcome refused = run(kProgram + robot + outputs + file);
      EXPECT_EQ(refused.code, 1) << outputs << file;
      EXPECT_THAT(refused.err, HasSubstr("would replace an input")) << outputs << file;
    }
    EXPECT_EQ(text(file), before);
  }
  EXPECT_EQ(run(kProgram + robot + "-o s.yaml --contact-sheet s.yaml").code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.yaml"));
}

TEST_F(CaptureProgram, DoesNotGoOnWithTheSessionOfAnotherRobot) {
  simulate(2);
  std::ofstream(folder_ / "samples.yaml")
      << "joint_states: {name: [other], position: [0.1]}\n"
         "observations: [{sensor_name: camera, features: []}]\n---\n";
  const Outcome refused = capture("--resume");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("samples.yaml:1: has no joint '"),
                                 HasSubstr("--resume goes on with the same robot")));
}

TEST_F(CaptureProgram, RecordsWhereAPersonHasPutTheRobot) {
  simulate(3);
  std::ofstream(folder_ / "keys.txt") << "\n\nq\n";
  const Outcome session = run(kProgram +
                              " capture sim/capture.yaml --urdf sim/robot.urdf --manual "
                              "--robot simulated:sim/scene.yaml -o manual.bag < keys.txt");
  EXPECT_THAT(session.out,
              AllOf(HasSubstr("press Enter"), HasSubstr("pose 2:"), Not(HasSubstr("pose 3:"))));
}

TEST_F(CaptureProgram, CapturesThePosesThatAPersonHasRecorded) {
  simulate(3);
  const std::string robot =
      " sim/capture.yaml --urdf sim/robot.urdf --robot simulated:sim/scene.yaml ";
  for (const std::string poses : {"p.yaml", "p.bag"}) {
    const Outcome recorded =
        run("printf 'led_finder\n\nq\n' | " + kProgram + " capture_poses" + robot + "-o " + poses);
    EXPECT_EQ(recorded.code, 0) << recorded.err;
    const Outcome session =
        run(kProgram + " capture" + robot + "--poses " + poses + " -o s-" + poses);
    EXPECT_THAT(session.out, HasSubstr("pose 1 of 1: led_finder: "));
  }
}

}  // namespace
}  // namespace kinecal::test
