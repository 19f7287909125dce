// kinecal simulate and kinecal capture: a simulated robot from poses to a calibration.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string kProgram = kinecal_program();
const std::string kCapturedUrdf =
    source_folder() + "/examples/mobile_manipulator/mobile_manipulator.urdf";

class CaptureProgram : public ProgramTest {
 protected:
  /// A robot with LEDs, its poses and configurations, in sim/.
  void simulate(int poses) {
    const Outcome made = run(kProgram + " simulate " + kCapturedUrdf + " --target leds --poses " +
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
      "--contact-sheet views.html --report report.html");
  EXPECT_EQ(session.code, 0) << session.out << session.err;
  EXPECT_THAT(session.out,
              AllOf(HasSubstr("led_finder: 4 features"), HasSubstr("'gripper 5 mm' is reached"),
                    HasSubstr("next, move"), HasSubstr("truth: '"), HasSubstr("by the URDF, "),
                    ContainsRegex("pose 1 of 40: .*features\n"),
                    ContainsRegex("pose 2 of 40: .*; at most [0-9]+ min left\n")));
  EXPECT_LT(samples(), 40);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "views.html"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "report.html"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "calibrated/calibrated.urdf"));
}

TEST_F(CaptureProgram, SaysWhyItGoesOnThoughTheAskedAccuracyIsCoarse) {
  simulate(15);
  const Outcome session = capture("--calibrate sim/calibrate.yaml --until 'gripper 100 mm'");
  EXPECT_EQ(session.code, 0) << session.out << session.err;
  EXPECT_THAT(session.out, HasSubstr("  not enough yet: the verdict is '"));
  EXPECT_THAT(session.out, HasSubstr("record more samples"));
  EXPECT_GE(samples(), 6);
}

TEST_F(CaptureProgram, RefusesOptionsThatABaseDoesNotHave) {
  write("base.yaml",
        "base_link: base_link\nmodels: []\nfree_params: [base_rollout_scale]\n"
        "error_blocks: [{name: base, type: odometry_to_wall}]\n");
  const auto said = [&](const std::string& options) {
    return kinecal("capture base.yaml --robot ws://127.0.0.1:1 -o d.bag " + options).err;
  };
  for (const char* option : {"--poses p.yaml", "--manual", "--resume", "--depth /d",
                             "--joint-states /j", "--calibrate c.yaml", "--contact-sheet s.html"}) {
    const std::string name = std::string(option).substr(0, std::string(option).find(' '));
    EXPECT_THAT(said(option), HasSubstr(name + " is of an arm, and base.yaml has an error block"));
  }
  EXPECT_THAT(said("--distance 2"), HasSubstr("--distance requires --drive"));
  EXPECT_THAT(kinecal("simulate " + kCapturedUrdf + " --target base --poses 3 -o drive").err,
              HasSubstr("--poses does not go with --target base"));
}

TEST_F(CaptureProgram, ResumesWhereItEnded) {
  simulate(6);
  // The robot is lost after a while: a fault of the scene.
  std::ofstream(folder_ / "sim/lost.yaml")
      << std::ifstream(folder_ / "sim/scene.yaml").rdbuf() << "faults: {connection_ends: 25}\n";
  const Outcome lost =
      run(kProgram +
          " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
          "--robot simulated:sim/lost.yaml -o samples.yaml --contact-sheet views.html");
  EXPECT_EQ(lost.code, 1) << lost.out;
  EXPECT_THAT(lost.err, HasSubstr("--resume goes on from here"));
  const std::string sheet = read("views.html");
  EXPECT_THAT(sheet, HasSubstr("<svg"));
  const int before = samples();
  EXPECT_GT(before, 0);
  EXPECT_LT(before, 6);
  EXPECT_EQ(capture("").code, 1);  // the file is there
  EXPECT_EQ(capture("--contact-sheet views.html").code, 1);
  const Outcome rest = capture("--resume --contact-sheet views.html");
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_THAT(rest.out, AllOf(HasSubstr("(" + std::to_string(before) + " from before)"),
                              HasSubstr("pose " + std::to_string(before + 1) + " of 6: "),
                              ContainsRegex("pose [2-5] of 6: .*; [0-9]+ s left\n"),
                              ContainsRegex("pose 6 of 6: .*features\n")))
      << "nothing is left after the last pose";
  EXPECT_EQ(samples(), 6);
  const std::string whole = read("views.html"), views = sheet.substr(0, sheet.find("</main>"));
  EXPECT_TRUE(whole.starts_with(views)) << "the views of the first session come first";
  const auto count_of = [](const std::string& page) {
    int figures = 0;
    for (std::size_t at = 0; (at = page.find("<figure", at)) != std::string::npos; ++at) ++figures;
    return figures;
  };
  const int shown = count_of(sheet), all = count_of(whole);
  EXPECT_GT(all, shown);
  EXPECT_THAT(rest.out,
              HasSubstr("views.html: what was found in " + std::to_string(all) + " views"));
  EXPECT_THAT(whole, HasSubstr("id=\"view-" + std::to_string(shown + 1) + "-title\""));
  EXPECT_EQ(capture("--resume").out,
            "samples.yaml: 6 samples from before; all poses of sim/poses.yaml are captured\n");
}

TEST_F(CaptureProgram, ResumingReplacesNoPageOfOthers) {
  simulate(3);
  ASSERT_EQ(capture("").code, 0);
  std::ofstream(folder_ / "views.html") << "<!DOCTYPE html><title>notes</title>";
  const Outcome rest = capture("--resume --contact-sheet views.html");
  EXPECT_EQ(rest.code, 1);
  EXPECT_THAT(rest.err, HasSubstr("views.html: exists and is no contact sheet"));
  EXPECT_EQ(read("views.html"), "<!DOCTYPE html><title>notes</title>");
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
              HasSubstr("the robot has no link 'grippr'; did you mean 'gripper'?"));
  EXPECT_THAT(capture("--calibrate sim/calibrate.yaml --until ''").err,
              HasSubstr("--until: must not be empty"));
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                     "--robot simulated:sim/scene.yaml -o s.txt")
          .err,
      HasSubstr("the name must end in .yaml, .bag or .mcap"));
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/truth.yaml "
                     "--robot simulated:sim/scene.yaml -o s.yaml")
          .err,
      HasSubstr("sim/truth.yaml: is not a list of poses"));
  EXPECT_THAT(
      run(kProgram + " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
                     "--robot pipe: -o s.yaml")
          .err,
      HasSubstr("--robot: 'pipe:' has no command"));
  EXPECT_THAT(capture("--velocity nan").err, HasSubstr("--velocity"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "samples.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "s.yaml"));
}

TEST_F(CaptureProgram, ReplacesNoInputAndNoSecondOutput) {
  simulate(2);
  const std::string robot =
      " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
      "--robot simulated:sim/scene.yaml --force ";
  for (const std::string file : {"sim/poses.yaml", "sim/robot.urdf", "sim/scene.yaml"}) {
    const std::string before = read(file);
    for (const std::string outputs : {"-o s.yaml --contact-sheet ", "-o "}) {
      if (outputs == "-o " && file.ends_with("urdf")) continue;  // no format of samples
      const Outcome refused = run(kProgram + robot + outputs + file);
      EXPECT_EQ(refused.code, 1) << outputs << file;
      EXPECT_THAT(refused.err, HasSubstr("would replace an input")) << outputs << file;
    }
    EXPECT_EQ(read(file), before);
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
              AllOf(HasSubstr("press Enter"),
                    HasSubstr("pose 2: skipped: nothing has moved since the last sample; move a "
                              "joint by more than 0.005 rad (0.3 deg) or 5 mm"),
                    HasSubstr("manual.bag: 1 sample of 2 poses"), Not(HasSubstr("pose 3:"))));
}

/// Nothing looks at a tip that touches: the joints are recorded, and which socket it was.
TEST_F(CaptureProgram, RecordsWhichSocketThePersonHasPutTheTipInto) {
  simulate(3);
  std::ofstream(folder_ / "touch.yaml")
      << "features:\n"
         "  socket_1: {type: TouchFinder, frame_id: socket_1}\n"
         "  socket_2: {type: TouchFinder, frame_id: socket_2, tip_frame: ball, x: 0.05}\n";
  std::ofstream(folder_ / "keys.txt") << "3\n2\nq\n";
  const Outcome session = run(kProgram +
                              " capture touch.yaml --urdf sim/robot.urdf --manual "
                              "--robot simulated:sim/scene.yaml -o touched.yaml < keys.txt");
  EXPECT_EQ(session.code, 0) << session.err;
  EXPECT_THAT(session.out, AllOf(HasSubstr("put the tip into one of socket_1, socket_2"),
                                 HasSubstr("'3' is none of them"),
                                 HasSubstr("touched.yaml: 1 sample of 1 pose")));
  Diagnostics diagnostics;
  const std::vector<Sample> samples =
      read_samples((folder_ / "touched.yaml").string(), diagnostics);
  ASSERT_EQ(samples.size(), 1u);
  EXPECT_FALSE(samples[0].joint_names.empty());
  ASSERT_NE(samples[0].observation("arm"), nullptr);
  EXPECT_EQ(samples[0].observation("arm")->features.at(0).frame, "ball");
  const Feature& place = samples[0].observation("touched")->features.at(0);
  EXPECT_EQ(place.frame, "socket_2");
  EXPECT_EQ(place.point, Vector3<double>(0.05, 0.0, 0.0));
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

TEST_F(CaptureProgram, AllPosesAreCheckedBeforeTheRobotMoves) {
  simulate(2);
  std::ofstream(folder_ / "sim/poses.yaml")
      << "- {joints: [elbow_flex_jont, head_pan_joint], positions: [0.1, 0.2]}\n"
         "- {joints: [head_pan_joint], positions: [7.5], features: [led_findr]}\n"
         "- {joints: [head_pan_joint], positions: [0.1]}\n"
         "- {joints: [head_pan_joint], positions: [7.5]}\n";
  const Outcome refused = capture("");
  EXPECT_EQ(refused.code, 1);
  EXPECT_EQ(refused.out, "");
  EXPECT_THAT(refused.err,
              AllOf(HasSubstr("sim/poses.yaml:1: the robot has no joint 'elbow_flex_jont'; did "
                              "you mean 'elbow_flex_joint'?"),
                    ContainsRegex("sim/poses.yaml:2: joint 'head_pan_joint' is beyond its "
                                  "limits, .*: at 7.5 \\(and 1 other pose\\)"),
                    HasSubstr("sim/poses.yaml:2: the configuration has no finder 'led_findr'; did "
                              "you mean 'led_finder'?")));
}

TEST_F(CaptureProgram, PosesALittleBeyondLimitsAreTheRobotsToRefuse) {
  simulate(2);
  const Robot robot = read_urdf(kCapturedUrdf);
  const double upper = robot.joint("head_tilt_joint").limits.value().upper;
  std::ofstream(folder_ / "sim/poses.yaml")
      << "- {joints: [head_tilt_joint], positions: [" << upper + 0.05 << "]}\n"
      << "- {joints: [head_tilt_joint], positions: [" << upper + 0.004 << "]}\n"
      << "- {joints: [head_tilt_joint], positions: [" << upper + 0.06 << "]}\n";
  const Outcome session = capture("");
  EXPECT_THAT(session.err,
              ContainsRegex("warning: sim/poses.yaml:1: joint 'head_tilt_joint' is a little beyond "
                            "its limits, .*; the robot may skip the pose \\(and 1 other pose\\)"));
  EXPECT_THAT(session.out,
              AllOf(ContainsRegex("pose 1 of 3: skipped: .*head_tilt_joint"),
                    Not(HasSubstr("pose 2 of 3: skipped")), HasSubstr("pose 3 of 3: skipped")));
}

TEST_F(CaptureProgram, OutputsAreCheckedBeforeTheRobotMoves) {
  simulate(2);
  std::filesystem::create_directory(folder_ / "folder");
  std::filesystem::create_directory(folder_ / "old");
  std::ofstream(folder_ / "old/calibrated.urdf") << "mine";
  std::ofstream(folder_ / "file") << "mine";
  const std::string calibrate = "--calibrate sim/calibrate.yaml --result ";
  for (const auto& [options, why] :
       {std::pair<std::string, std::string>(calibrate + "file", "file: is not a folder"),
        {calibrate + "file/result", "file/result: cannot be created"},
        {calibrate + "old", "old/calibrated.urdf: exists; use --force"},
        {"--contact-sheet sheet.jpg", "sheet.jpg: is written as HTML"},
        {"--contact-sheet folder --force", "folder: is a folder, not a file"},
        {"--contact-sheet file/sheet.html", "file: is not a folder"}}) {
    const Outcome refused = capture(options);
    EXPECT_EQ(refused.code, 1) << options;
    EXPECT_THAT(refused.err, HasSubstr(why)) << options;
    EXPECT_EQ(refused.out, "") << options;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "samples.yaml"));
}

TEST_F(CaptureProgram, ResumesAFileThatWasCutOff) {
  simulate(2);
  ASSERT_EQ(capture("").code, 0);
  const std::string all = read("samples.yaml");
  const std::size_t last = all.rfind("---\n", all.size() - 5) + 4;
  const int line = 1 + static_cast<int>(std::count(all.begin(), all.begin() + long(last), '\n'));
  for (const std::size_t size : {last + (all.size() - last) / 2, all.size() - 4}) {
    std::ofstream(folder_ / "samples.yaml") << all.substr(0, size);
    const Outcome rest = capture("--resume");
    EXPECT_EQ(rest.code, 0) << rest.err;
    EXPECT_THAT(rest.err, HasSubstr("samples.yaml:" + std::to_string(line) +
                                    ": the last sample has no '---' after it"));
    EXPECT_THAT(rest.out, HasSubstr("2 samples of 1 pose"));
    EXPECT_EQ(read("samples.yaml").substr(0, last), all.substr(0, last));
  }
}

TEST_F(CaptureProgram, CtrlCEndsARobotThatHangs) {
  simulate(2);
  std::ofstream(folder_ / "hang.sh")
      << "read request; echo $$ > child; while true; do sleep 1; done\n";
  const Outcome ended =
      run("bash -c 'set -m; " + kProgram +
          " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
          "--robot \"pipe:exec sh hang.sh\" -o s.yaml & "
          "until test -s child; do sleep 0.1; done; kill -INT $!; wait $!'");
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("error: interrupted\n"));
  EXPECT_NE(run("kill -0 $(cat child)").code, 0) << "the child is still there";
}

TEST_F(CaptureProgram, CtrlCEndsWaitingForAPerson) {
  simulate(2);
  const Outcome ended = run("bash -c 'set -m; sleep 600 | " + kProgram +
                            " capture sim/capture.yaml --urdf sim/robot.urdf --manual "
                            "--robot simulated:sim/scene.yaml -o s.yaml > said & "
                            "until grep -q Enter said; do sleep 0.1; done; "
                            "sleep 0.2; kill -INT -- -$!; wait $!'");
  EXPECT_EQ(ended.code, 130) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr("error: interrupted\n"));
}

TEST_F(CaptureProgram, ARobotThatOnlySendsGarbageEndsTheSession) {
  simulate(6);
  const auto session = [&](const std::string& robot) {
    return run(kProgram +
               " capture sim/capture.yaml --urdf sim/robot.urdf --poses sim/poses.yaml "
               "-o s.yaml --robot 'pipe:" +
               robot + "'");
  };
  const Outcome garbage = session("while read l; do echo garbage; done");
  EXPECT_EQ(garbage.code, 1);
  EXPECT_THAT(garbage.err, AllOf(HasSubstr("the answer cannot be read: 'garbage' is not JSON, from "
                                           "character 1 on; the robot has not moved"),
                                 Not(HasSubstr("--resume")), Not(HasSubstr("exception"))));
  EXPECT_THAT(garbage.out, Not(HasSubstr("pose 1")));
  const Outcome none = session("false");
  EXPECT_EQ(none.err, "error: 'false' ended with exit code 1\n");
  EXPECT_EQ(none.out, "");
}

}  // namespace
}  // namespace kinecal::test
