// kinecal init as its users meet it: by options, and by questions on a terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Init : public test::ProgramTest {
 protected:
  static std::string urdf(const std::string& robot) {
    return test::source_folder() + "/examples/robots/" + robot + "/" + robot + ".urdf";
  }
  /// Nobody can be asked.
  [[nodiscard]] Outcome init(const std::string& robot, const std::string& options) const {
    return run(test::kinecal_program() + " init --urdf " + urdf(robot) + " " + options +
               " < /dev/null");
  }
  [[nodiscard]] Outcome check(const std::string& robot) const {
    return run(test::kinecal_program() + " check --urdf " + urdf(robot) +
               " --config calibrate.yaml");
  }

  /// On a terminal, where these keys are typed.
  [[nodiscard]] Outcome type(const std::string& robot, const std::string& options,
                             const std::string& keys) const {
    int terminal = -1;
    const std::string call = "cd " + folder_.string() + " && exec " + test::kinecal_program() +
                             " init --urdf " + urdf(robot) + " " + options;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
      execl("/bin/sh", "sh", "-c", call.c_str(), nullptr);
      _exit(127);
    }
    Outcome outcome;
    EXPECT_EQ(::write(terminal, keys.data(), keys.size()), std::ssize(keys));
    constexpr int kPatience = 60000;  // milliseconds; a program that asks on would wait for ever
    pollfd readable{terminal, POLLIN, 0};
    char buffer[4096];
    ssize_t size = 0;
    while (poll(&readable, 1, kPatience) > 0 &&
           (size = ::read(terminal, buffer, sizeof buffer)) > 0) {
      outcome.out.append(buffer, static_cast<std::size_t>(size));
    }
    close(terminal);
    int status = 0;
    waitpid(child, &status, 0);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return outcome;
  }
};

TEST_F(Init, WritesByOptionsWhatCheckAccepts) {
  const Outcome made = init("fetch",
                            "--target leds,ground --arm gripper_led_frame --camera "
                            "head_camera_rgb_optical_frame --base base_link");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, AllOf(HasSubstr("wrote calibrate.yaml"), HasSubstr("next: kinecal check")));
  EXPECT_THAT(read("calibrate.yaml"), AllOf(HasSubstr("frame: gripper_led_frame"), HasSubstr("# "),
                                            HasSubstr("ground_plane")));
  const Outcome checked = check("fetch");
  EXPECT_EQ(checked.code, 0) << checked.err;
  EXPECT_EQ(checked.err, "");
}

TEST_F(Init, TakesWhatCannotBeOtherwiseAndSaysSo) {
  const Outcome made = init("ur5e", "--target tracker");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("--arm reflector (the only one)"));
  EXPECT_EQ(check("ur5e").code, 0);
}

TEST_F(Init, NamesTheOptionWhereNobodyCanBeAsked) {
  const Outcome target = init("fetch", "");
  EXPECT_EQ(target.code, 1);
  EXPECT_THAT(target.err, AllOf(HasSubstr("--target is required"), HasSubstr("leds, checker")));
  const Outcome arm = init("fetch", "--target leds");
  EXPECT_EQ(arm.code, 1);
  EXPECT_THAT(arm.err, AllOf(HasSubstr("--arm is required"), HasSubstr("gripper_led_frame")));
  const Outcome camera = init("ur5e", "--target leds");
  EXPECT_EQ(camera.code, 1);
  EXPECT_THAT(camera.err, HasSubstr("--target: no link of the URDF looks like a camera; add it to "
                                    "the URDF, or give --camera LINK"));
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Init, ReportsAWrongAnswerAndTheNearestName) {
  const Outcome link = init("fetch", "--target tracker --arm griper_link");
  EXPECT_EQ(link.code, 1);
  EXPECT_THAT(link.err,
              AllOf(HasSubstr("--arm: no link 'griper_link'"), HasSubstr("'gripper_link'?")));
  const Outcome target = init("fetch", "--target trackr");
  EXPECT_EQ(target.code, 1);
  EXPECT_THAT(target.err,
              AllOf(HasSubstr("--target: 'trackr'"), HasSubstr("did you mean 'tracker'?")));
  EXPECT_THAT(
      init("fetch", "--target '?'").err,
      HasSubstr("'?' is not a target; choose one of leds, checkerboard, apriltag, charuco, "
                "world_checkerboard, world_apriltag, world_charuco, tracker, ground, robot"));
  EXPECT_EQ(init("fetch", "--target leds,tracker").code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Init, KeepsAFileThatIsThereUnlessForced) {
  write("calibrate.yaml", "mine");
  const Outcome refused = init("ur5e", "--target tracker");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("calibrate.yaml: exists"), HasSubstr("--force")));
  EXPECT_EQ(read("calibrate.yaml"), "mine");
  EXPECT_EQ(init("ur5e", "--target tracker --force").code, 0);
  EXPECT_THAT(read("calibrate.yaml"), HasSubstr("models:"));
  EXPECT_EQ(init("ur5e", "--target tracker --output deep/er/c.yaml").code, 0);
  EXPECT_THAT(read("deep/er/c.yaml"), HasSubstr("models:"));
}

TEST_F(Init, NeverWritesOverTheUrdf) {
  fs::copy(urdf("ur5e"), folder_ / "my robot.urdf");
  const std::string before = read("my robot.urdf");
  const Outcome made = run(test::kinecal_program() +
                           " init --urdf 'my robot.urdf' --target tracker --force --output "
                           "'./my robot.urdf' < /dev/null");
  EXPECT_EQ(made.code, 1);
  EXPECT_THAT(made.err, HasSubstr("my robot.urdf: would replace an input"));
  EXPECT_EQ(read("my robot.urdf"), before);
  const Outcome next =
      run(test::kinecal_program() + " init --urdf 'my robot.urdf' --target tracker < /dev/null");
  EXPECT_THAT(next.out, HasSubstr("check --urdf 'my robot.urdf' --config calibrate.yaml"));
}

TEST_F(Init, NamesFramesByOptionsAndWarnsOfUnusedOnes) {
  const Outcome made = init(
      "ur5e", "--target tracker --target-frame ball --tracker-frame at960 --camera-type camera2d");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.err, HasSubstr("warning: --camera-type is not used with target tracker"));
  EXPECT_THAT(read("calibrate.yaml"),
              AllOf(HasSubstr("{name: at960, x: true"), HasSubstr("{name: ball, x: true"),
                    Not(HasSubstr("smr")), Not(HasSubstr("tracker_frame"))));
  EXPECT_EQ(check("ur5e").code, 0);
  EXPECT_THAT(init("ur5e", "--target tracker --force --tracker-frame elbow_joint").err,
              HasSubstr("--tracker-frame: 'elbow_joint' is a link or a joint"));
}

TEST_F(Init, AsksOnATerminal) {
  // Target 2; the floor: no; arm: 9, which is not in the list, then 1; camera: misspelt, then Enter;
  // type: Enter; its name: refused, then eye; frame of the board: a joint, then charuco; base: Enter.
  const Outcome asked = type("fetch", "",
                             "2\n\n9\n1\nhead_camera_rgb_optcal_frame\n\n\narm\neye\n"
                             "elbow_flex_joint\ncharuco\n\n");
  EXPECT_EQ(asked.code, 0) << asked.out;
  EXPECT_THAT(asked.out, AllOf(HasSubstr("2  checkerboard: "), HasSubstr("no such number"),
                               HasSubstr("did you mean 'head_camera_rgb_optical_frame'?"),
                               HasSubstr("camera2d: pixels"), HasSubstr("wrote calibrate.yaml")));
  EXPECT_THAT(asked.out,
              AllOf(HasSubstr("(sensor_name)? [camera]: "), HasSubstr("'arm' cannot be the camera"),
                    HasSubstr("the board (frame_id)? [checkerboard]: "),
                    HasSubstr("'elbow_flex_joint' is a link or a joint"),
                    HasSubstr("measurements compared? [base_link]: ")));
  EXPECT_THAT(read("calibrate.yaml"),
              AllOf(HasSubstr("{name: charuco, x: true"), HasSubstr("eye_z_offset"),
                    HasSubstr("frame: gripper_link"), Not(HasSubstr("ground_plane"))));
  EXPECT_EQ(check("fetch").code, 0);
}

TEST_F(Init, DoesNotAskWhatOptionsSay) {
  const Outcome asked =
      type("panda",
           "--target world_checkerboard --camera-type camera2d --robot-camera-name eye "
           "--target-frame wall --base panda_link0",
           "\n");
  EXPECT_EQ(asked.code, 0) << asked.out;
  EXPECT_THAT(asked.out, AllOf(Not(HasSubstr("measured against")), HasSubstr("optical frame"),
                               Not(HasSubstr("samples call"))));
  EXPECT_THAT(read("calibrate.yaml"), AllOf(HasSubstr("model_2d: eye"), HasSubstr(" - eye_fx"),
                                            HasSubstr("{name: wall, x: true")));
  EXPECT_EQ(check("panda").code, 0);
}

TEST_F(Init, ProposesNoTargetOfACameraWhereThereIsNone) {
  const Outcome asked = type("ur5e", "", "leds\n\n\n\n\n\n");
  EXPECT_EQ(asked.code, 0) << asked.out;
  EXPECT_THAT(asked.out,
              AllOf(HasSubstr("1  tracker: "), HasSubstr("point: nothing measures"),
                    Not(HasSubstr("checkerboard")),
                    HasSubstr("no link of the URDF looks like a camera; add it to the URDF")));
  EXPECT_EQ(check("ur5e").code, 0);
  const Outcome silent = init("ur5e", "--force");
  EXPECT_EQ(silent.code, 1);
  EXPECT_THAT(silent.err,
              HasSubstr("--target is required, because the input is not a terminal; use "
                        "one of tracker, point, tool"));
}

TEST_F(Init, RefusesBeforeItAsks) {
  // The camera of the Panda is on its hand, so it cannot see LEDs on it from elsewhere.
  const Outcome leds = type("panda", "--target leds", "");
  EXPECT_EQ(leds.code, 1) << leds.out;
  EXPECT_THAT(leds.out, AllOf(HasSubstr("moves with the arm and sees the same in every pose"),
                              HasSubstr("world_apriltag"), Not(HasSubstr("Which link"))));
  const Outcome camera = type("ur5e", "--target leds --arm tool0", "");
  EXPECT_EQ(camera.code, 1) << camera.out;
  EXPECT_THAT(camera.out, AllOf(HasSubstr("no link of the URDF looks like a camera"),
                                Not(HasSubstr("Which link"))));
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Init, WritesTheCaptureThatGoesWithItsConfiguration) {
  const std::string options =
      "--target apriltag --arm gripper_link --camera head_camera_rgb_optical_frame --camera-type "
      "camera2d";
  const Outcome made = init("fetch", options);
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(made.out,
              AllOf(HasSubstr("wrote capture.yaml\n  fill in what is zero"),
                    HasSubstr("next: kinecal detect capture.yaml --images images --poses poses.csv "
                              "--camera camera.yaml --frame head_camera_rgb_optical_frame "
                              "-o samples.yaml && kinecal calibrate --urdf ")));
  EXPECT_THAT(read("calibrate.yaml"), HasSubstr("{name: apriltag_grid, x: true"));
  EXPECT_THAT(read("capture.yaml"),
              AllOf(HasSubstr("AprilTagFinder2d"), HasSubstr("chain_sensor_name: arm"),
                    HasSubstr("frame_id: apriltag_grid"), HasSubstr("camera_sensor_name: camera")));
  write("capture.yaml", "features: mine\n");
  const Outcome again = init("fetch", options + " --force");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("capture.yaml is there and is kept; with this configuration, it "
                                   "needs\n  camera_sensor_name: camera, chain_sensor_name: arm"));
  EXPECT_EQ(read("capture.yaml"), "features: mine\n");
  EXPECT_EQ(init("fetch", options + " --output other.yaml --capture c2.yaml").code, 0);
  EXPECT_THAT(read("c2.yaml"), HasSubstr("apriltag_grid"));
}

TEST_F(Init, KeepsTheAnswersWhenAnErrorFollowsThem) {
  const Outcome asked = type("panda", "", "1\n\n\n\neye\n\npanda_hand\n");
  EXPECT_EQ(asked.code, 1) << asked.out;
  const std::string call =
      "kinecal init --urdf " + urdf("panda") +
      " --target world_checkerboard --camera camera_color_optical_frame --camera-type camera3d "
      "--robot-camera-name eye --target-frame checkerboard --base panda_hand";
  EXPECT_THAT(asked.out,
              AllOf(HasSubstr("error: --camera: "), HasSubstr("to keep your answers: " + call)));
}

TEST_F(Init, TakesSeveralReflectors) {
  const Outcome made =
      init("ur5e", "--target tracker --arm tool0 --target-frame smr_1,smr_2,smr_3");
  EXPECT_EQ(made.code, 0) << made.err;
  EXPECT_THAT(read("calibrate.yaml"),
              AllOf(HasSubstr("{name: smr_1, x: true"), HasSubstr("{name: smr_2, x: true"),
                    HasSubstr("{name: smr_3, x: true"), HasSubstr("{name: smr_3, x: 0.0")));
  EXPECT_EQ(check("ur5e").code, 0);
  EXPECT_THAT(init("ur5e", "--target tracker --force --target-frame smr,smr").err,
              HasSubstr("--target-frame: 'smr' occurs twice"));
  EXPECT_THAT(init("panda",
                   "--force --target world_checkerboard --camera camera_color_optical_frame "
                   "--target-frame a,b")
                  .err,
              HasSubstr("--target-frame: only a tracker has several reflectors"));
}

/// A guess that is far too small would make a wrong model look like many bad samples.
TEST_F(Init, GuessesNoSigmaOfATracker) {
  ASSERT_EQ(init("ur5e", "--target tracker --arm tool0").code, 0);
  EXPECT_THAT(read("calibrate.yaml"), Not(HasSubstr("\n   sigma: ")));
}

TEST_F(Init, SaysWhoReadsTheZeros) {
  const Outcome made = init("ur5e", "--target tracker --arm tool0");
  EXPECT_THAT(made.out,
              HasSubstr("joint zeros: calibrate writes them into <calibration rising>, which "
                        "robot_state_publisher, MoveIt and the UR driver do not read; 'calibrate "
                        "--offsets origin' moves the joints' origins instead\n"));
  const std::string urdf_text = [&] {
    std::ifstream file(urdf("ur5e"));
    return std::string(std::istreambuf_iterator<char>(file), {});
  }();
  const std::string end = "</robot>";
  const auto with = [&](const std::string& joints) {
    std::string text = urdf_text;
    write("own.urdf",
          text.insert(text.rfind(end), "<ros2_control>" + joints + "</ros2_control>\n"));
    return run(test::kinecal_program() +
               " init --force --urdf own.urdf --target tracker --arm tool0 < /dev/null")
        .out;
  };
  const auto joint = [](const std::string& name) {
    return "<joint name=\"" + name + "\"><param name=\"offset\">0.0</param></joint>";
  };
  EXPECT_THAT(with(joint("elbow_joint")),
              HasSubstr("joint zeros: calibrate writes those of elbow_joint into <param "
                        "name=\"offset\"> of <ros2_control>, others into <calibration rising>"));
  EXPECT_THAT(
      with(joint("shoulder_pan_joint") + joint("shoulder_lift_joint") + joint("elbow_joint") +
           joint("wrist_1_joint") + joint("wrist_2_joint") + joint("wrist_3_joint")),
      HasSubstr("joint zeros: calibrate adds them to <param name=\"offset\"> of "
                "<ros2_control>\n"));
}

TEST_F(Init, WritesNothingWhereTheAnswersEnd) {
  const Outcome left = type("fetch", "", "1\n\n\x04");
  EXPECT_EQ(left.code, 1) << left.out;
  EXPECT_THAT(left.out, HasSubstr("not answered; nothing is written"));
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Init, NeedsNoQuestionsWithSamples) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  KINECAL_NEEDS_DATA("fetch/synth");
  struct Set {
    std::string urdf, samples, options, says;
  };
  const Set sets[] = {
      {"ur5_tracker/ur5.urdf", "ur5_tracker/grid.yaml", "--target tracker", "target tracker; arm"},
      {"fetch/synth/fetch_arm_head.urdf", "fetch/synth/samples.yaml",
       "--target leds --arm wrist_roll_link --camera head_camera_rgb_optical_frame",
       "target leds; arm wrist_roll_link; camera head_camera_rgb_optical_frame ('camera', "
       "points)"}};
  for (const Set& set : sets) {
    const std::string call = test::kinecal_program() + " init --force --urdf " +
                             (test::data_folder() / set.urdf).string() + " ";
    ASSERT_EQ(run(call + set.options + " --output asked.yaml < /dev/null").code, 0);
    const Outcome made = run(call + "--from " + (test::data_folder() / set.samples).string() +
                             " --output from.yaml < /dev/null");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, AllOf(HasSubstr("from the samples: " + set.says),
                                HasSubstr("next: kinecal calibrate --urdf ")));
    EXPECT_EQ(read("from.yaml"), read("asked.yaml"));
  }
}

TEST_F(Init, SeesFromSamplesWhetherTheHandHoldsTheBoard) {
  const std::string mobile =
      test::source_folder() + "/examples/mobile_manipulator/mobile_manipulator.urdf";
  for (const std::string& robot : {mobile, urdf("panda")}) {
    const std::string call = test::kinecal_program() + " ";
    ASSERT_EQ(run(call + "simulate " + robot + " --target apriltag --poses 8 -o sim --force").code,
              0);
    const YAML::Node config = YAML::LoadFile((folder_ / "sim/calibrate.yaml").string());
    const auto camera = config["models"][1]["frame"].as<std::string>();
    const Outcome seen =
        run(call +
            "detect sim/capture.yaml --images sim/images --poses sim/poses.csv --camera "
            "sim/camera.yaml --frame " +
            camera + " -o samples.yaml --force");
    if (seen.err.find("libapriltag") != std::string::npos) GTEST_SKIP() << seen.err;
    ASSERT_EQ(seen.code, 0) << seen.err;
    const Outcome made =
        run(call + "init --force --urdf sim/robot.urdf --from samples.yaml < /dev/null");
    ASSERT_EQ(made.code, 0) << made.err;
    EXPECT_THAT(made.out, HasSubstr(robot == mobile ? "target checkerboard; arm gripper_link"
                                                    : "target world_checkerboard; camera"));
    EXPECT_EQ(read("calibrate.yaml"), read("sim/calibrate.yaml"));
  }
}

/// What init writes of a real robot calibrates it as far as its parameters can: the figures are
/// those of an independent implementation.
TEST_F(Init, WritesWhatCalibratesARealRobotAsItStands) {
  KINECAL_NEEDS_DATA("ur5_tracker");
  KINECAL_NEEDS_DATA("fetch/synth");
  struct Set {
    std::string urdf, samples, options;
    double rms;  ///< metres
  };
  const Set sets[] = {
      {"ur5_tracker/ur5.urdf", "ur5_tracker/grid.yaml", "--target tracker", 0.560881e-3},
      {"fetch/synth/fetch_arm_head.urdf", "fetch/synth/samples.yaml",
       "--target leds --arm wrist_roll_link --camera head_camera_rgb_optical_frame", 1.7320508e-3}};
  for (const Set& set : sets) {
    const std::string robot = " --urdf " + (test::data_folder() / set.urdf).string();
    const Outcome made =
        run(test::kinecal_program() + " init --force" + robot + " " + set.options + " < /dev/null");
    ASSERT_EQ(made.code, 0) << made.err;
    const Outcome done =
        run(test::kinecal_program() + " calibrate --force --config calibrate.yaml --output out" +
            robot + " --samples " + (test::data_folder() / set.samples).string());
    ASSERT_EQ(done.code, 0) << done.err;
    const YAML::Node report = YAML::LoadFile((folder_ / "out/report.json").string());
    constexpr double kLoss =
        0.02;  // a robust loss and a prior change the least squares of the figure
    EXPECT_NEAR(report["error_blocks"][0]["after"]["rms"].as<double>(), set.rms, kLoss * set.rms)
        << set.urdf;
    const YAML::Node observability = report["observability"][0];
    EXPECT_LE(observability["unobservable"].size(), 1u) << "the tilt, which a prior keeps";
  }
}

TEST_F(Init, RefusesOptionsThatABaseOrAMagnetometerDoesNotHave) {
  EXPECT_THAT(init("ur5e", "--target base --arm tool0").err,
              HasSubstr("--arm does not go with --target base"));
  EXPECT_THAT(init("ur5e", "--target base --touched-link base_link").err,
              HasSubstr("--touched-link does not go with --target base"));
  EXPECT_THAT(init("ur5e", "--target magnetometer --from t.csv --drive odometry").err,
              HasSubstr("--drive does not go with --target magnetometer"));
  EXPECT_THAT(init("ur5e", "--target magnetometer,leds").err,
              HasSubstr("magnetometer does not go into one configuration with others; call init "
                        "for magnetometer alone"));
  for (const char* size : {"--track-width -1", "--gyro-scale 0", "--wheel-radius 60"}) {
    EXPECT_THAT(init("ur5e", std::string("--target base --drive odometry --seen pose ") + size).err,
                HasSubstr("is no number above 0 and at most"))
        << size;
  }
  EXPECT_FALSE(fs::exists(folder_ / "calibrate.yaml"));
}

TEST_F(Init, KeepsTheUsersColumnsOfAMagnetometer) {
  // A turn about z in a field of 40 microtesla.
  std::string table = "a,b,c,mx,my,mz\n";
  for (int i = 0; i < 24; ++i) {
    const double angle = 0.26 * i;
    const std::string x = std::to_string(40.0 * std::cos(angle));
    const std::string y = std::to_string(40.0 * std::sin(angle));
    table += x + "," + y + ",5," + x + "," + y + ",5\n";
  }
  write("turn.csv", table);
  const std::string call = " init --target magnetometer --from turn.csv --force";
  ASSERT_EQ(run(test::kinecal_program() + call).code, 0);
  EXPECT_THAT(read("columns.yaml"), HasSubstr("mag_x: mx"));
  const std::string own = "separator: comma\nconditions:\n  mag_x: a\n  mag_y: b\n  mag_z: c\n";
  write("columns.yaml", own);
  const Outcome again = run(test::kinecal_program() + call);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("columns.yaml is there and is used"));
  EXPECT_EQ(read("columns.yaml"), own);
}

}  // namespace
}  // namespace kinecal
