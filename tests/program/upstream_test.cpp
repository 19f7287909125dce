// kinecal under the names of robot_calibration's programs, with their arguments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "support/data.hpp"
#include "support/launch_scene.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::MatchesRegex;

constexpr const char* kCaptureYaml = "chains: []\nfeatures: {leds: {type: LedFinder}}\n";
constexpr const char* kCalibrateYaml =
    "robot_calibration:\n  ros__parameters:\n    verbose: true\n    calibration_steps: [one]\n";

/// As Fetch's.
constexpr const char* kCaptureLaunch = R"xml(<launch>
  <arg name="velocity_factor" default="1.0" />
  <node pkg="robot_calibration" type="calibrate" name="robot_calibration"
        args="$(find fetch_calibration)/config/calibration_poses.bag" required="true">
    <param name="velocity_factor" value="$(arg velocity_factor)" />
    <rosparam file="$(find fetch_calibration)/config/capture.yaml" command="load" />
    <rosparam file="$(find fetch_calibration)/config/calibrate.yaml" command="load" />
  </node>
  <node pkg="rosbag" type="record" name="calibration_bagger"
        args="--bz2 -o recorded/calibration_data calibration_data robot_description" >
    <param name="mkdir_tmp" command="mkdir -m 777 -p recorded" />
  </node>
  <include file="$(find fetch_moveit_config)/launch/move_group.launch" />
</launch>)xml";

class Upstream : public ProgramTest {
 protected:
  Upstream() {
    for (const char* name : {"calibrate", "capture_poses", "viz", "to_rpy", "base_calibration",
                             "magnetometer_calibration", "calibrate_robot"}) {
      fs::create_symlink(kinecal_program(), folder_ / name);
    }
    write("capture.yaml", kCaptureYaml);
    write("calibrate.yaml", kCalibrateYaml);
  }
  /// Packages as in Fetch's workspace, in ws/.
  void add_workspace(const std::string& calibrate_yaml) const {
    fs::create_directories(folder_ / "ws/fetch_calibration/launch");
    fs::create_directories(folder_ / "ws/fetch_calibration/config");
    fs::create_directories(folder_ / "ws/fetch_bringup/launch");
    write("ws/fetch_calibration/launch/capture.launch", kCaptureLaunch);
    write("ws/fetch_calibration/config/capture.yaml", kCaptureYaml);
    write("ws/fetch_calibration/config/calibrate.yaml", calibrate_yaml);
    write("ws/fetch_bringup/launch/fetch.launch", kLaunch);
  }
  /// Runs a program of the folder, in the surroundings of a ROS.
  [[nodiscard]] Outcome as(const std::string& call,
                           const std::string& ros = "ROS_VERSION=2") const {
    return run("env -u ROS_DISTRO -u AMENT_PREFIX_PATH ROS_PACKAGE_PATH=" +
               (folder_ / "ws").string() + " " + ros + " timeout 600 ./" + call + " < /dev/null");
  }
  /// The commands of kinecal that it runs; a date is DATE, and whether /tmp has results to replace does not matter.
  [[nodiscard]] std::string commands(const std::string& call,
                                     const std::string& ros = "ROS_VERSION=2") const {
    const Outcome shown = as(call + " --show", ros);
    EXPECT_EQ(shown.code, 0) << shown.err;
    const std::string dated =
        std::regex_replace(shown.out, std::regex("[0-9]{4}(_[0-9]{2}){5}"), "DATE");
    return std::regex_replace(dated, std::regex("(--output /tmp --upstream-names) --force"), "$1");
  }
  void expect_refused(const std::string& call, const std::string& message) const {
    const Outcome refused = as(call);
    EXPECT_EQ(refused.code, 1) << call;
    EXPECT_EQ(refused.out, "");
    EXPECT_THAT(refused.err, HasSubstr(message)) << call;
  }
};

TEST_F(Upstream, CalibrateTakesFilesOfParametersAndRemappings) {
  const std::string files = "--params-file capture.yaml --params-file calibrate.yaml";
  EXPECT_EQ(commands("calibrate --from-bag data.bag --urdf r.urdf --ros-args " + files + " --"),
            "kinecal calibrate --urdf r.urdf --config calibrate.yaml --samples data.bag --output "
            "/tmp --upstream-names --verbose\n");
  EXPECT_EQ(commands("calibrate --manual --output out --ros-args " + files +
                     " -r joint_states:=/arm/states --log-level debug -p verbose:=false --"),
            "kinecal capture capture.yaml --robot ws://localhost:8765 --joint-states /arm/states "
            "--manual --output /tmp/calibration_data_DATE.mcap\n"
            "kinecal calibrate --config calibrate.yaml --samples /tmp/calibration_data_DATE.mcap "
            "--output out --upstream-names\n");
  EXPECT_THAT(commands("calibrate --ros-args " + files + " --"),
              HasSubstr(" --poses calibration_poses.yaml "));
  EXPECT_THAT(commands("calibrate poses.bag --robot pipe:x --ros-args " + files + " --"),
              HasSubstr("capture.yaml --robot pipe:x --poses poses.bag --output "));
  // Files without a date in their names are those of the last result.
  fs::create_directories(folder_ / "out");
  write("out/report.json", "{}");
  EXPECT_THAT(commands("calibrate --from-bag b --output out --ros-args " + files + " --"),
              HasSubstr("--samples b --output out --upstream-names --force"));
}

TEST_F(Upstream, CalibrateTakesALaunchFileOfFetch) {
  add_workspace(kCalibrateYaml);
  const std::string config = (folder_ / "ws/fetch_calibration/config/").string();
  const std::string launch = "--launch ws/fetch_calibration/launch/capture.launch";
  EXPECT_EQ(commands("calibrate " + launch + " velocity_factor:=0.5"),
            "kinecal capture " + config + "capture.yaml --robot ws://localhost:8765 --poses " +
                config +
                "calibration_poses.bag --velocity 0.5 --output recorded/calibration_data_DATE.bag\n"
                "kinecal calibrate --config " +
                config +
                "calibrate.yaml --samples recorded/calibration_data_DATE.bag --output /tmp "
                "--upstream-names --verbose\n");
  EXPECT_EQ(commands("calibrate --from-bag " + launch),
            "kinecal calibrate --config " + config +
                "calibrate.yaml --samples /tmp/calibration_data.bag --output /tmp "
                "--upstream-names --verbose\n");
  EXPECT_EQ(commands("calibrate_robot --arm --directory out --to robot"),
            commands("calibrate --output out " + launch) + "kinecal install out --to robot\n");
}

TEST_F(Upstream, CalibrateTakesTheParameterServerIfRoslaunchHasStartedIt) {
  // What roslaunch has put there, and how a node is started.
  write("rosparam",
        "#!/bin/sh\n[ \"$1 $3\" = 'dump /fetch/cal' ] && cat capture.yaml all.yaml > \"$2\"\n");
  write("all.yaml", "models: []\n_: _\n");
  fs::permissions(folder_ / "rosparam", fs::perms::owner_all);
  fs::create_directories(folder_ / "tmp");
  const std::string ros = "ROS_VERSION=1 TMPDIR=tmp PATH=.:$PATH";
  EXPECT_THAT(
      commands("calibrate --from-bag b.bag __name:=cal __ns:=/fetch __log:=/dev/null", ros),
      MatchesRegex("kinecal calibrate --config tmp/kinecal_[^/]+/cal.yaml --samples b.bag .*\n"));
  EXPECT_THAT(
      commands("calibrate poses.bag __name:=cal __ns:=/fetch _velocity_factor:=0.3", ros),
      ContainsRegex("kinecal capture tmp/kinecal_[^/]+/cal.yaml --robot ws://localhost:8765 "
                    "--poses poses.bag --velocity 0.3 --output "
                    "/tmp/calibration_data_DATE.bag\n"));
  fs::remove_all(folder_ / "tmp");  // where printed commands find their parameters
  fs::create_directories(folder_ / "tmp");
  EXPECT_EQ(as("calibrate --from-bag absent.bag --output out __name:=cal __ns:=/fetch", ros).code,
            1);
  const Outcome other = as("calibrate --from-bag b.bag __name:=other", ros);
  EXPECT_TRUE(fs::is_empty(folder_ / "tmp")) << "parameters are left behind";
  EXPECT_EQ(other.code, 1);
  EXPECT_THAT(other.err, HasSubstr("fails, so the parameters of node '/other' are not known"));
}

TEST_F(Upstream, OtherProgramsAreCommandsOfKinecal) {
  EXPECT_EQ(commands("capture_poses"),
            "kinecal capture_poses --robot ws://localhost:8765 --output calibration_poses.yaml\n");
  EXPECT_EQ(commands("capture_poses --config capture.yaml", "ROS_VERSION=1"),
            "kinecal capture_poses capture.yaml --robot ws://localhost:8765 --output "
            "calibration_poses.bag\n");
  EXPECT_EQ(commands("viz data.bag --ros-args --params-file calibrate.yaml --"),
            "kinecal calibrate --config calibrate.yaml --samples data.bag --dry-run --quiet "
            "--report /tmp/viz_DATE.html --scene /tmp/viz_DATE.mcap\n");
  EXPECT_EQ(commands("viz data.bag out/calibration_1.yaml"), "kinecal evaluate out data.bag\n");
  EXPECT_EQ(commands("magnetometer_calibration --ros-args -p bag_file_name:=mag.bag --"),
            "kinecal init --target magnetometer --from mag.bag --output "
            "/tmp/magnetometer_DATE/calibrate.yaml\n"
            "kinecal calibrate --config /tmp/magnetometer_DATE/calibrate.yaml --samples mag.bag "
            "--output /tmp --upstream-names\n");
}

TEST_F(Upstream, ABaseIsDrivenOrTakenFromARecording) {
  const std::string seen = "--target base --drive odometry --seen wall";
  const std::string rest =
      " --output /tmp/base_DATE/calibrate.yaml\n"
      "kinecal calibrate --config /tmp/base_DATE/calibrate.yaml --samples drive.bag --output /tmp "
      "--upstream-names\n";
  EXPECT_EQ(commands("base_calibration --from-bag drive.bag"),
            "kinecal init " + seen + " --from drive.bag" + rest);
  EXPECT_EQ(
      commands("base_calibration --from-bag drive.bag --ros-args -p imu_gyro_scale:=0.001 --"),
      "kinecal init " + seen + " --gyro-scale 0.001 --from drive.bag" + rest);
  EXPECT_EQ(commands("base_calibration --output out odom:=/wheel_odom", "ROS_VERSION=1"),
            "kinecal init " + seen +
                " --output out/base_DATE/drive/base.yaml\n"
                "kinecal capture out/base_DATE/drive/base.yaml --robot ws://localhost:8765 --topic "
                "odom=/wheel_odom --drive --output out/base_calibration_DATE.bag\n"
                "kinecal init " +
                seen +
                " --from out/base_calibration_DATE.bag --output "
                "out/base_DATE/calibrate.yaml\n"
                "kinecal calibrate --config out/base_DATE/calibrate.yaml --samples "
                "out/base_calibration_DATE.bag --output out --upstream-names\n");
  EXPECT_EQ(
      commands("calibrate_robot --base --from-bag drive.bag --directory out --to robot"),
      "kinecal init " + seen +
          " --track-width 0.37476 --gyro-scale 0.001221729 --from drive.bag "
          "--output out/base_calibration/base_DATE/calibrate.yaml\n"
          "kinecal calibrate --config out/base_calibration/base_DATE/calibrate.yaml --samples "
          "drive.bag --output out/base_calibration --upstream-names\n"
          "kinecal install out/base_calibration --to robot\n");
}

TEST_F(Upstream, ToRpyPrintsAsUpstream) {
  // A turn about x and none about the others.
  EXPECT_EQ(as("to_rpy -0.5 0 0").out, "-0.5, 0, 0\n");
  EXPECT_EQ(as("to_rpy 0 0 0.25").out, "0, 0, 0.25\n");
  expect_refused("to_rpy 1 2", "takes three numbers: to_rpy A B C");
}

TEST_F(Upstream, WrongArgumentsAreNamedWithTheNearest) {
  const std::string files = " --ros-args --params-file capture.yaml --params-file calibrate.yaml";
  expect_refused("calibrate --form-bag x",
                 "'--form-bag' is not an argument; did you mean '--from-bag'?");
  expect_refused("calibrate --manual --ros-args --param-file x", "did you mean '--params-file'?");
  expect_refused("calibrate --manual --ros-args -p verbos:=true", "did you mean 'verbose'?");
  expect_refused("calibrate --manual _verbos:=1", "did you mean 'verbose'?");
  expect_refused("calibrate --manual --ros-args -p verbose", "-p verbose: is not NAME:=VALUE");
  expect_refused("calibrate a.yaml b.yaml" + files, "'b.yaml' is one word too many");
  expect_refused("calibrate a.yaml --from-bag b" + files, "so there is nothing to capture");
  expect_refused("calibrate --from-bag b", "the configuration of the calibration is missing");
  expect_refused("calibrate --manual --ros-args --params-file calibrate.yaml",
                 "the configuration of the capture is missing");
  expect_refused("calibrate --manual" + files + " --params-file calibrate2.yaml",
                 "calibrate2.yaml: cannot be read");
  write("more.yaml", "models: []\n");
  expect_refused(
      "calibrate --manual" + files + " --params-file more.yaml",
      "more.yaml has parameters of the calibration, as has calibrate.yaml; put them into");
  write("odd.yaml", "colour: red\n");
  expect_refused("calibrate --manual" + files + " --params-file odd.yaml",
                 "odd.yaml has none of the parameters of a capture");
  expect_refused("calibrate --launch none.launch", "none.launch: cannot be read");
  add_workspace(kCalibrateYaml);
  expect_refused("calibrate --launch ws/fetch_calibration/launch/capture.launch velocity:=1",
                 "capture.launch: has no argument 'velocity'");
  write("other.launch",
        "<launch><node pkg='robot_calibration' type='calibrate_base' name='b'/></launch>");
  expect_refused("calibrate --launch other.launch",
                 "other.launch: starts no node 'calibrate' of robot_calibration; it has "
                 "robot_calibration/calibrate_base");
  expect_refused("calibrate_robot --instal", "did you mean '--install'?");
  expect_refused("calibrate_robot", "nothing to do; it takes [--arm]");
  // Options of other programs have no effect: they are refused.
  expect_refused("capture_poses --output out", "'--output' is not an argument");
  expect_refused("calibrate_robot --arm --output out", "'--output' is not an argument");
  expect_refused("to_rpy --urdf r.urdf 0 0 0", "'--urdf' is not an argument");
  expect_refused("viz b.bag --robot ws://x:1", "'--robot' is not an argument");
  EXPECT_EQ(as("to_rpy --help").out,
            "usage: to_rpy A B C\n"
            "       [--show: print the commands of kinecal instead of running them]\n");
  const Outcome help = as("calibrate --help");
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.out, HasSubstr("usage: calibrate [POSES | --manual | --from-bag [BAG]]"));
}

/// The only file of the folder whose name matches, without it; a failure if there is none.
std::string only_file(const fs::path& folder, const std::string& pattern) {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::regex_match(name, std::regex(pattern))) found.push_back(name);
  }
  EXPECT_EQ(found.size(), 1U) << pattern;
  return found.empty() ? "" : found.front();
}

TEST_F(Upstream, AFetchIsCalibratedFromItsBagAndInstalled) {
  KINECAL_NEEDS_DATA("fetch/synth");
  const fs::path data = data_folder() / "fetch/synth";
  std::ifstream config(data / "calibrate.yaml");
  add_workspace({std::istreambuf_iterator<char>(config), {}});
  fs::copy(data / "calibration_data.bag", folder_);
  const std::string date = "[0-9]{4}(_[0-9]{2}){5}";

  // ros2 run robot_calibration calibrate --from-bag ...
  const Outcome done =
      as("calibrate --from-bag calibration_data.bag --output out --ros-args "
         "--params-file ws/fetch_calibration/config/calibrate.yaml");
  ASSERT_EQ(done.code, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("+ kinecal calibrate --config ws/fetch_calibration"));
  const std::string result = only_file(folder_ / "out", "calibration_" + date + "[.]yaml");
  const std::string stem = result.substr(12);
  EXPECT_TRUE(fs::exists(folder_ / "out" / ("calibrated_" + stem.substr(0, 19) + ".urdf")));
  for (const char* camera : {"depth_", "rgb_"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / (camera + stem))) << camera << stem;
  }
  EXPECT_THAT(read("out/" + result),
              AllOf(HasSubstr("depth_info: depth_" + stem), HasSubstr("rgb_info: rgb_" + stem)));

  // rosrun robot_calibration viz ..., with the parameters of the launch file
  EXPECT_EQ(as("viz calibration_data.bag --output page --launch "
               "ws/fetch_calibration/launch/capture.launch")
                .code,
            0);
  EXPECT_THAT(read("page/" + only_file(folder_ / "page", "viz_" + date + "[.]html")),
              HasSubstr("</html>"));
  EXPECT_EQ(as("viz calibration_data.bag out/" + result).code, 0);

  // calibrate_robot
  fs::create_directories(folder_ / "robot");
  write("robot/robot.launch", kLaunch);
  const Outcome installed = as("calibrate_robot --install --directory out --to robot");
  EXPECT_EQ(installed.code, 0) << installed.err;
  EXPECT_THAT(installed.out, HasSubstr("restart the robot's drivers"));
  EXPECT_THAT(read("robot/robot.launch"), HasSubstr("/robot/calibrated_" + stem.substr(0, 19)));
  const std::string day = as("calibrate_robot --date --to robot").out;
  EXPECT_THAT(day, MatchesRegex("[0-9]+-[0-9]+-[0-9]+ [0-9:]+\n"));
  const Outcome reset = as("calibrate_robot --reset --to robot");
  EXPECT_EQ(reset.code, 0) << reset.err;
  EXPECT_EQ(read("robot/robot.launch"), kLaunch);
  EXPECT_EQ(as("calibrate_robot --reset --to robot").code, 0);
  EXPECT_EQ(as("calibrate_robot --restore --to robot").code, 0);
  EXPECT_EQ(as("calibrate_robot --date --to robot").out, day);
}

TEST_F(Upstream, ABagWithoutSamplesIsNamed) {
  KINECAL_NEEDS_DATA("fetch/calibration_poses.bag");
  const std::string bag = (data_folder() / "fetch/calibration_poses.bag").string();
  const Outcome refused =
      as("calibrate --output out --from-bag " + bag + " --ros-args --params-file " +
         (data_folder() / "fetch").string() + "/calibrate.yaml");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("calibration_poses.bag: no messages of "
                                     "robot_calibration_msgs/CalibrationData in this bag"));
  EXPECT_FALSE(fs::exists(folder_ / "out/report.json"));
}

TEST_F(Upstream, ASessionThatIsTooShortGivesNoResult) {
  ASSERT_EQ(kinecal("simulate " + source_folder() +
                    "/examples/mobile_manipulator/mobile_manipulator.urdf --target leds --poses 3 "
                    "-o sim")
                .code,
            0);
  const Outcome session =
      as("calibrate sim/poses.yaml --robot simulated:sim/scene.yaml --urdf sim/robot.urdf --output "
         "out --ros-args --params-file sim/capture.yaml --params-file sim/calibrate.yaml");
  EXPECT_EQ(session.code, 2) << session.err;
  EXPECT_THAT(session.out, HasSubstr("pose 3 of 3"));
  EXPECT_THAT(session.err, HasSubstr("+ kinecal calibrate --urdf sim/robot.urdf"));
  EXPECT_FALSE(fs::exists(folder_ / "out/report.json"));
  const std::string recorded = session.err.substr(session.err.find("/tmp/calibration_data_"));
  EXPECT_TRUE(fs::remove(recorded.substr(0, recorded.find('\n'))));
}

}  // namespace
}  // namespace kinecal::test
