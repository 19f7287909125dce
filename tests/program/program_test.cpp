// The program as its users meet it: exit codes, messages, files.  Every bad input gets a message
// with the file, the line where there is one and the name; exit code 1; nothing is written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <yaml-cpp/yaml.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <pugixml.hpp>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/calibrated.hpp"
#include "support/camera_infos.hpp"
#include "support/data.hpp"
#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const char* const kUrdf = R"(<?xml version="1.0"?>
<robot name="tiny">
  <!-- two joints and a camera on a mast -->
  <link name="base_link"/>
  <link name="upper"/>
  <link name="hand"/>
  <link name="mast"/>
  <link name="camera_optical_frame"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.5" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="upper"/>
    <axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.4 0 0" rpy="0 0 0"/>
    <parent link="upper"/>
    <child link="hand"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="mast_joint" type="fixed">
    <origin xyz="-0.3 0 1.2" rpy="0 0.6 0"/>
    <parent link="base_link"/>
    <child link="mast"/>
  </joint>
  <joint name="optical_joint" type="fixed">
    <origin rpy="-1.5707963267948966 0 -1.5707963267948966"/>
    <parent link="mast"/>
    <child link="camera_optical_frame"/>
  </joint>
  <joint name="drifter" type="floating">
    <parent link="base_link"/>
    <child link="balloon"/>
  </joint>
  <link name="balloon"/>
</robot>
)";

const char* const kConfig = R"(base_link: base_link
models:
 - name: arm
   type: chain
   frame: hand
 - name: camera
   type: camera3d
   frame: camera_optical_frame
free_params:
 - elbow
 - camera_z_offset
free_frames:
 - {name: mast_joint, x: true, y: true, z: true, roll: true, pitch: true, yaw: true}
error_blocks:
 - name: hand_eye
   type: chain3d_to_chain3d
   model_a: camera
   model_b: arm
)";

std::vector<Sample> samples() {
  const Robot robot = parse_urdf(kUrdf, "tiny.urdf");
  const RuntimeChain arm = make_chain(robot, "base_link", "hand");
  const RuntimeChain camera = make_chain(robot, "base_link", "camera_optical_frame");
  std::vector<Sample> all;
  for (int n = 0; n < 20; ++n) {
    Sample sample;
    sample.joint_names = {"shoulder", "elbow"};
    sample.joint_positions = {0.6 * std::sin(1.7 * n), 0.5 * std::cos(2.3 * n)};
    const auto truth = [&](const std::string& joint) {
      return *sample.position(joint) + (joint == "elbow" ? 0.02 : 0.0);
    };
    const Pose<double> base_T_hand = forward_kinematics(arm, truth);
    const Pose<double> camera_T_base = forward_kinematics(camera, truth).inverse();
    const CameraInfo info = test::camera_info(550.0, 550.0);
    Observation seen{"camera", {}, info}, held{"arm", {}};
    for (const Vector3<double>& p : {Vector3<double>(0.1, 0, 0), Vector3<double>(0.2, 0.05, 0),
                                     Vector3<double>(0.2, -0.05, 0.03)}) {
      held.features.push_back({"hand", p});
      seen.features.push_back({"camera_optical_frame", camera_T_base * (base_T_hand * p)});
    }
    sample.observations = {seen, held};
    all.push_back(sample);
  }
  return all;
}

using test::Outcome;

class Program : public test::ProgramTest {
 protected:
  Program() {
    write("tiny.urdf", kUrdf);
    write("c.yaml", kConfig);
    write_all(samples());
  }

  void write_all(const std::vector<Sample>& all) const {
    std::ofstream file(folder_ / "s.yaml");
    write_samples(file, all);
  }
  /// Writes a file of the good input with one piece of text replaced.
  void spoil(const std::string& name, const std::string& from, const std::string& to) const {
    std::string text = read(name);
    const auto at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write(name, text.replace(at, from.size(), to));
  }

  [[nodiscard]] Outcome run(const std::string& arguments,
                            const std::string& program = test::kinecal_program()) const {
    return ProgramTest::run(program + " " + arguments);
  }
  /// A test may calibrate several times.
  [[nodiscard]] Outcome calibrate(const std::string& more = "") const {
    return run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --output out --force " +
               more);
  }

  [[nodiscard]] Outcome check(const std::string& more = "") const {
    return run("check --urdf tiny.urdf --config c.yaml --samples s.yaml " + more);
  }

  /// The input as it stands is refused with this message, by check too, and nothing is written.
  void expect_refused(const testing::Matcher<std::string>& message) const {
    const Outcome result = calibrate();
    EXPECT_EQ(result.code, 1) << result.out << result.err;
    EXPECT_THAT(result.err, message);
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    const Outcome checked = check();
    EXPECT_EQ(checked.code, 1) << checked.out;
    EXPECT_THAT(checked.err, message);
  }
};

TEST_F(Program, CalibratesAndWritesAllFiles) {
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("hand_eye"), HasSubstr("elbow"), HasSubstr("1.146"),
                                HasSubstr(" · 8 files in out\n")));
  for (const char* name : {"calibrated.urdf", "calibration.yaml", "depth_camera.yaml",
                           "rgb_camera.yaml", "report.json"}) {
    EXPECT_TRUE(fs::exists(folder_ / "out" / name)) << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 8) << "left something";
  EXPECT_NEAR(YAML::LoadFile((folder_ / "out/calibration.yaml").string())["elbow"].as<double>(),
              0.02, 1e-9);
  const YAML::Node report = YAML::LoadFile((folder_ / "out/report.json").string());
  EXPECT_TRUE(report["converged"].as<bool>());
  EXPECT_EQ(report["error_blocks"][0]["count"].as<int>(), 60);
  EXPECT_EQ(report["steps"][0]["num_parameters"].as<int>(), 8);
}

TEST_F(Program, BothOffsetStylesDescribeTheSameRobot) {
  ASSERT_EQ(calibrate("--offsets rising").code, 0);
  const Robot rising = read_urdf((folder_ / "out/calibrated.urdf").string());
  ASSERT_EQ(calibrate("--offsets origin").code, 0);
  const Robot origin = read_urdf((folder_ / "out/calibrated.urdf").string());
  const double offset =
      YAML::LoadFile((folder_ / "out/calibration.yaml").string())["elbow"].as<double>();
  const auto tip = [&](const Robot& robot, double added) {
    return forward_kinematics(
        make_chain(robot, "camera_optical_frame", "hand"),
        [&](const std::string& joint) { return joint == "elbow" ? 0.3 + added : -0.2; });
  };
  const Pose<double> a = tip(rising, offset), b = tip(origin, 0.0);
  EXPECT_LE((a.rotation - b.rotation).norm() + (a.translation - b.translation).norm(), 1e-12);
}

/// The origins of tiny.urdf's joints by other means: what the robot's programs read.
TEST_F(Program, OffsetsGoWhereTheUrdfHasThem) {
  EXPECT_THAT(calibrate().out, HasSubstr("--offsets origin"));
  EXPECT_THAT(read("out/calibrated.urdf"), HasSubstr("<calibration rising=\"0.0"));
  EXPECT_THAT(calibrate("--offsets rising").out, Not(HasSubstr("--offsets origin")));
  spoil("tiny.urdf", "</robot>",
        "<ros2_control name=\"c\" type=\"system\"><joint name=\"elbow\">"
        "<param name=\"offset\">0.5</param></joint></ros2_control>\n</robot>");
  const Outcome found = calibrate();
  EXPECT_EQ(found.code, 0) << found.err;
  EXPECT_THAT(found.out, Not(HasSubstr("--offsets origin")));
  EXPECT_THAT(read("out/calibrated.urdf"),
              AllOf(ContainsRegex("<param name=\"offset\">0.5(19|2)"), Not(HasSubstr("rising"))));
}

TEST_F(Program, ARobotThatRos2ControlDoesNotHaveIsNamed) {
  const Outcome refused = calibrate("--offsets ros2_control");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, HasSubstr("error: tiny.urdf: <ros2_control> has no joint 'elbow'"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

/// A calibration with files of the robot's programs.
TEST_F(Program, WritesOriginsHomingOffsetsAndXacro) {
  const std::string homing =
      "{\n \"elbow\": {\"id\": 2, \"drive_mode\": 0, \"homing_offset\": 100},\n"
      " \"gripper\": {\"id\": 3, \"drive_mode\": 0, \"homing_offset\": 5}\n}\n";
  write("arm.json", homing);
  std::string xacro = kUrdf;
  xacro.replace(xacro.find("-0.3 0 1.2"), 10, "-0.3 0 ${h}");
  write("tiny.xacro", xacro);
  // the elbow's zero is 0.02 rad: 13.04 ticks
  const Outcome servos = calibrate("--offsets origin --kinematics k.yaml --homing arm.json");
  EXPECT_EQ(servos.code, 0) << servos.err;
  EXPECT_EQ(read("arm.json"), std::string(homing).replace(homing.find("100"), 3, "87"));
  EXPECT_EQ(read("arm.json.backup_1"), homing);
  EXPECT_THAT(servos.err, AllOf(HasSubstr("motors that are no joint: gripper"),
                                HasSubstr("elbow: homing_offset 100 becomes 87"),
                                HasSubstr("so the URDF is without them")));
  EXPECT_THAT(read("out/calibrated.urdf"), Not(HasSubstr("0.019")));
  EXPECT_EQ(
      YAML::LoadFile((folder_ / "k.yaml").string())["kinematics"]["elbow"]["pitch"].as<double>(),
      0.0);
  const Outcome lost = calibrate("--homing arm.json --report arm.json");
  EXPECT_THAT(lost.err, HasSubstr("arm.json: would replace an input"));
  EXPECT_THAT(calibrate("--kinematics out/calibrated.urdf").err,
              HasSubstr("is in the folder of the results"));
  const std::string files = "--offsets origin --kinematics k.yaml --xacro tiny.xacro";
  const Outcome result = calibrate(files);
  EXPECT_EQ(result.code, 0) << result.err;
  const YAML::Node elbow = YAML::LoadFile((folder_ / "k.yaml").string())["kinematics"]["elbow"];
  EXPECT_NEAR(elbow["x"].as<double>(), 0.4, 1e-9);
  EXPECT_NEAR(elbow["pitch"].as<double>(), 0.02, 1e-6);
  EXPECT_THAT(read("tiny.xacro"),
              AllOf(HasSubstr("xyz=\"-0.3 0 ${h}\""), HasSubstr("rpy=\"0 0.0")));
  EXPECT_THAT(result.err, HasSubstr("tiny.xacro:24: joint 'mast_joint': xyz=\"-0.3 0 ${h}\" is an "
                                    "expression; it should become xyz="));
  const std::string patched = read("tiny.xacro"), kinematics = read("k.yaml");
  const Outcome again = calibrate(files);
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_THAT(calibrate("--homing arm.json").err, HasSubstr("holds these zeros already"));
  EXPECT_EQ(read("arm.json"), std::string(homing).replace(homing.find("100"), 3, "87"));
  EXPECT_EQ(read("tiny.xacro"), patched);
  EXPECT_EQ(read("k.yaml"), kinematics);
}

TEST_F(Program, PatchesTheFileThatAXacroIncludes) {
  fs::create_directories(folder_ / "parts");
  const std::string top =
      "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>\n"
      "<xacro:include filename='parts/arm.xacro'/>\n"
      "<xacro:include filename='parts/gone.xacro'/>\n</robot>\n";
  write("top.xacro", top);
  write("parts/arm.xacro", kUrdf);
  const Outcome result = calibrate("--offsets origin --xacro top.xacro");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(read("top.xacro"), top);
  EXPECT_THAT(read("parts/arm.xacro"), HasSubstr("rpy=\"0 0.0"));
  EXPECT_THAT(result.err, AllOf(HasSubstr("parts/arm.xacro: has the calibration of"),
                                HasSubstr("top.xacro:3: 'parts/gone.xacro' is included and not "
                                          "patched: there is no such file")));
}

/// Before the work begins, and before anything is written.
TEST_F(Program, FilesThatCannotBePatchedAreRefused) {
  write("other.yaml", "a: 1\n");
  write("other.json", "{\"motor\": {\"homing_offset\": 1}}");
  const auto expect_refusal = [&](const std::string& option, const std::string& message) {
    const Outcome refused = calibrate(option);
    EXPECT_EQ(refused.code, 1) << option;
    EXPECT_THAT(refused.err, HasSubstr("error: " + message)) << option;
    EXPECT_FALSE(fs::exists(folder_ / "out")) << option;
  };
  expect_refusal("--kinematics other.yaml", "other.yaml: exists and has no 'kinematics:'");
  expect_refusal("--kinematics c.yaml", "c.yaml: would replace an input");
  expect_refusal("--homing missing.json", "missing.json: cannot be read: No such file");
  expect_refusal("--homing other.json", "other.json: no motor has the name of a joint");
  expect_refusal("--xacro missing.xacro", "missing.xacro: cannot be read");
  expect_refusal("--xacro c.yaml", "c.yaml: would replace an input");
  expect_refusal("--xacro other.yaml", "other.yaml:");
  write("top.xacro",
        "<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>"
        "<xacro:include filename='tiny.urdf'/></robot>");
  expect_refusal("--xacro top.xacro", "tiny.urdf: would replace an input");
  expect_refusal("--kinematics /proc/k.yaml", "/proc");
  EXPECT_EQ(read("other.yaml"), "a: 1\n");
}

TEST_F(Program, GivesTheSameBytesForTheSameInput) {
  ASSERT_EQ(calibrate().code, 0);
  const std::string urdf = read("out/calibrated.urdf"), yaml = read("out/calibration.yaml");
  ASSERT_EQ(calibrate().code, 0);
  EXPECT_EQ(read("out/calibrated.urdf"), urdf);
  EXPECT_EQ(read("out/calibration.yaml"), yaml);
}

TEST_F(Program, ThreadsDoNotChangeAByteOfTheResult) {
  ASSERT_EQ(calibrate("--threads 1").code, 0);
  const std::string one = read("out/calibration.yaml");
  ASSERT_EQ(calibrate("--threads 3").code, 0);
  EXPECT_EQ(read("out/calibration.yaml"), one);
  EXPECT_EQ(calibrate("--threads 0").code, 1);
}

TEST_F(Program, TheStackedCostEndsAtTheSameParametersAndIsRecorded) {
  ASSERT_EQ(calibrate().code, 0);
  const auto elbow = [&] {
    return YAML::LoadFile((folder_ / "out/calibration.yaml").string())["elbow"].as<double>();
  };
  const auto form = [&] {
    return YAML::LoadFile((folder_ / "out/report.json").string())["steps"][0]["form"]
        .as<std::string>();
  };
  const double compressed = elbow();
  EXPECT_EQ(form(), "compressed");
  ASSERT_EQ(calibrate("--cost stacked").code, 0);
  EXPECT_NEAR(elbow(), compressed, 1e-9);
  EXPECT_EQ(form(), "stacked");
}

TEST_F(Program, UpstreamNamesCarryTheDateAndLeaveOutTheNameCamera) {
  ASSERT_EQ(calibrate("--upstream-names").code, 0);
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(folder_ / "out")) {
    names.push_back(file.path().filename().string());
  }
  const std::string date = "[0-9]+_[0-9]+_[0-9]+_[0-9]+_[0-9]+_[0-9]+";
  using testing::MatchesRegex;
  EXPECT_THAT(names,
              testing::UnorderedElementsAre(MatchesRegex("calibrated_" + date + "\\.urdf"),
                                            MatchesRegex("calibration_" + date + "\\.yaml"),
                                            MatchesRegex("depth_" + date + "\\.yaml"),
                                            MatchesRegex("rgb_" + date + "\\.yaml"), "report.json",
                                            "residuals.csv", "original.urdf", "config.yaml"));
}

TEST_F(Program, DryRunWritesNothing) {
  EXPECT_EQ(calibrate("--dry-run").code, 0);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Program, ExitsWith2AndWritesNothingWhenItDoesNotConverge) {
  write("c.yaml", std::string(kConfig) + "max_num_iterations: 1\n");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 2) << result.out;
  EXPECT_THAT(result.err, HasSubstr("failed, no results written"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

TEST_F(Program, StartsAtRandomOnRequestAndSaysWhatItFound) {
  EXPECT_THAT(calibrate("--dry-run").out, Not(HasSubstr("start")));
  const Outcome result = calibrate("--dry-run --starts 5");
  EXPECT_EQ(result.code, 0) << result.err;
  const std::string starts =
      "5 random starts (joints within 10 degrees or 2 cm, frames within 10 degrees and 5 cm); 1 "
      "minimum, cost ";
  EXPECT_THAT(result.out, HasSubstr(starts));
  const auto line = [&](const std::string& text) {
    const std::size_t at = text.find(starts);
    return at < text.size() ? text.substr(at, text.find('\n', at) - at) : "no line";
  };
  EXPECT_EQ(line(calibrate("--dry-run --starts 5 --threads 3").out), line(result.out));
}

TEST_F(Program, ReportsTimeAndSpeed) {
  const Outcome result = calibrate();
  EXPECT_THAT(result.out,
              ContainsRegex("20 samples, [0-9.]+ s: reading [0-9.]+ s, solving [0-9.]+ "
                            "s \\([0-9]+ iterations, [0-9.]+ million samples a second, "));
}

/// The program at each level that the processor has: an option of the dynamic loader chooses it.
TEST_F(Program, CalibratesAlikeAtEachLevelOfTheProcessor) {
  if (!test::has_levels()) GTEST_SKIP() << "the program is built without KINECAL_X86_64_LEVELS";
  const std::string loader = "/lib64/ld-linux-x86-64.so.2";
  const std::string levels_here = run("--help", loader).out;
  if (levels_here.find("--glibc-hwcaps-mask") == std::string::npos) {
    GTEST_SKIP() << "this dynamic loader knows no levels (glibc before 2.33)";
  }
  auto all = samples();
  double phase = 0.0;  // up to 2 mm off, so that there is a cost to compare
  for (Sample& sample : all) {
    for (Feature& feature : sample.observations[0].features) {
      feature.point.x() += 0.002 * std::sin(phase += 3.1);
    }
  }
  write_all(all);

  std::string best;
  double baseline_cost = 0.0;
  for (const std::string level : {"x86-64", "x86-64-v3", "x86-64-v4"}) {
    if (level != "x86-64" && levels_here.find(level + " (supported") == std::string::npos) {
      std::cout << "not run: " << level << ", which this processor or its loader does not have\n";
      continue;
    }
    const std::string masked =
        loader + " --glibc-hwcaps-mask " + level + " " + test::kinecal_program();
    EXPECT_THAT(run("--version", masked).out, HasSubstr("(" + level + ","));
    const Outcome result = run(
        "calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --output out --force", masked);
    ASSERT_EQ(result.code, 0) << level << ": " << result.err;
    EXPECT_THAT(result.out, HasSubstr("samples a second, " + level + ")"));
    const double cost =
        YAML::LoadFile((folder_ / "out/report.json").string())["steps"][0]["final_cost"]
            .as<double>();
    if (best.empty()) baseline_cost = cost;
    constexpr double kRounding =
        1e-9;  // sums in another order, and fused; far below what is printed
    EXPECT_NEAR(cost, baseline_cost, kRounding * baseline_cost) << level;
    best = level;
  }
  EXPECT_GT(baseline_cost, 1e-6);
  EXPECT_THAT(run("--version").out, HasSubstr("(" + best + ",")) << "not chosen at start-up";
}

/// Eigen allocates and aligns them differently at each level.
TEST_F(Program, GivesNoMatrixOfVariableSizeToTheLibraryOfALevel) {
  if (!test::has_levels()) GTEST_SKIP() << "the program is built without KINECAL_X86_64_LEVELS";
  const Outcome symbols =
      run("--dynamic --demangle --undefined-only " + test::kinecal_program(), "nm");
  ASSERT_EQ(symbols.code, 0) << symbols.err;
  EXPECT_THAT(symbols.out, HasSubstr("kinecal::calibrate("));
  EXPECT_THAT(symbols.out, Not(ContainsRegex("kinecal::[^\n]*Eigen::Matrix<double, -1")));
}

TEST_F(Program, InspectShowsSensorsJointsAndGaps) {
  auto all = samples();
  all[3].observations.pop_back();
  write_all(all);
  const Outcome result = run("inspect s.yaml");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("20 samples"), HasSubstr("640x480"), HasSubstr("elbow"),
                                HasSubstr("sensor 'arm' is missing in 1 of 20 samples")));
}

TEST_F(Program, IntrinsicsMayComeFromAFile) {
  ASSERT_EQ(calibrate().code, 0);
  const std::string urdf = read("out/calibrated.urdf"), camera = read("out/depth_camera.yaml");
  auto all = samples();
  write("camera.yaml", to_camera_info_yaml(*all[0].observations[0].camera, "camera"));
  for (Sample& sample : all) sample.observations[0].camera.reset();
  write_all(all);
  fs::remove_all(folder_ / "out");
  expect_refused(HasSubstr("camera"));
  const Outcome result = calibrate("--camera camera=camera.yaml");
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(read("out/calibrated.urdf"), urdf);
  EXPECT_EQ(read("out/depth_camera.yaml"), camera);
  const std::string check = "check --urdf tiny.urdf --config c.yaml --samples s.yaml --camera ";
  EXPECT_EQ(run(check + "camera=camera.yaml").code, 0);
  EXPECT_THAT(run(check + "camra=camera.yaml").err, HasSubstr("did you mean 'camera'?"));
  EXPECT_THAT(run(check + "camera=none.yaml").err, HasSubstr("error: none.yaml: cannot be read"));
  write("depth_camera.yaml", read("camera.yaml"));
  const Outcome own =
      run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --output . "
          "--camera camera=depth_camera.yaml");
  EXPECT_EQ(own.code, 1);
  EXPECT_THAT(own.err, HasSubstr("would replace an input"));
}

TEST_F(Program, ShowsACameraFileAndWritesItAsCameraInfo) {
  write("chain.yaml",
        "cam0:\n  camera_model: pinhole\n  intrinsics: [500, 501, 320, 240]\n"
        "  distortion_model: radtan\n  distortion_coeffs: [0.1, 0, 0, 0]\n"
        "  resolution: [640, 480]\n");
  const Outcome shown = run("camera chain.yaml --output x/info.yaml --name head");
  EXPECT_EQ(shown.code, 0) << shown.err;
  EXPECT_THAT(shown.out, AllOf(HasSubstr("640 x 480"), HasSubstr("plumb_bob"),
                               HasSubstr("P              500 0 320 0 0 501 240 0 0 0 1 0")));
  EXPECT_THAT(shown.err, HasSubstr("warning: chain.yaml:1: "));
  EXPECT_THAT(read("x/info.yaml"), HasSubstr("camera_name: head\n"));
  EXPECT_EQ(run("camera x/info.yaml --output y.yaml --keys message").code, 0);
  EXPECT_THAT(read("y.yaml"), HasSubstr("d: [0.1, 0.0, 0.0, 0.0, 0.0]\n"));
  EXPECT_THAT(run("camera y.yaml --output y.yaml").err, HasSubstr("would replace an input"));
  EXPECT_THAT(run("camera y.yaml --keys message").err, HasSubstr("--output"));
  spoil("chain.yaml", "radtan", "fov");
  EXPECT_THAT(run("camera chain.yaml").err,
              HasSubstr("error: chain.yaml:4: cam0: distortion_model "));
}

TEST_F(Program, AResultGoesOntoTheRobotWithEitherNames) {
  fs::create_directory(folder_ / "robot");
  const std::string launch =
      "<launch>\n  <param name=\"calibration_date\" value=\"\"/>\n"
      "  <param name=\"robot_description\" textfile=\"a.urdf\"/>\n"
      "  <param name=\"head_camera/driver/z_offset_mm\" value=\"0\"/>\n"
      "  <param name=\"head_camera/driver/z_scaling\" value=\"1\"/>\n"
      "  <arg name=\"rgb_camera_info_url\" default=\"\"/>\n"
      "  <arg name=\"depth_camera_info_url\" default=\"\"/>\n</launch>\n";
  for (const char* names : {"", "--upstream-names"}) {
    write("robot/robot.launch", launch);
    fs::remove_all(folder_ / "out");
    ASSERT_EQ(calibrate(names).code, 0);
    const Outcome installed = run("install out --to robot");
    EXPECT_EQ(installed.code, 0) << installed.err;
    pugi::xml_document xml;
    ASSERT_TRUE(xml.load_file((folder_ / "robot/robot.launch").c_str()));
    const pugi::xml_node description =
        xml.child("launch").find_child_by_attribute("name", "robot_description");
    EXPECT_NO_THROW((void)read_urdf(description.attribute("textfile").value()));
    const std::string date = run("install --date --to robot").out;
    EXPECT_THAT(date, ContainsRegex("^20[0-9-]+ [0-9:]+\n$"));
    EXPECT_EQ(run("install --restore --to robot").code, 0);
    EXPECT_EQ(read("robot/robot.launch"), launch);
  }
}

TEST_F(Program, CheckReportsAllErrorsAtOnce) {
  spoil("c.yaml", " - elbow", " - elbwo\n - sholder");
  spoil("c.yaml", "frame: hand", "frame: hnad");
  const Outcome result = run("check --urdf tiny.urdf --config c.yaml --samples s.yaml");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, AllOf(HasSubstr("c.yaml:10: "), HasSubstr("'elbwo'"),
                                HasSubstr("did you mean 'elbow'?"), HasSubstr("'sholder'"),
                                HasSubstr("did you mean 'shoulder'?"), HasSubstr("'hnad'"),
                                HasSubstr("did you mean 'hand'?")));
}

TEST_F(Program, AcceptsASampleFileTwiceAndSaysSo) {
  const Outcome result =
      run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml ./s.yaml --output out");
  EXPECT_EQ(result.code, 0);
  EXPECT_THAT(result.err, HasSubstr("warning: ./s.yaml: is given twice"));
}

// Bad input, one test each.

TEST_F(Program, RefusesAMissingUrdf) {
  fs::remove(folder_ / "tiny.urdf");
  expect_refused(HasSubstr("tiny.urdf"));
}

TEST_F(Program, RefusesAMalformedUrdfWithTheLine) {
  spoil("tiny.urdf", "<link name=\"hand\"/>", "<link name=\"hand\">");
  expect_refused(HasSubstr("tiny.urdf:"));
}

TEST_F(Program, RefusesALinkThatDoesNotExist) {
  spoil("c.yaml", "frame: hand", "frame: hnad");
  expect_refused(AllOf(HasSubstr("c.yaml:3: model 'arm'"), HasSubstr("'hnad'"),
                       HasSubstr("did you mean 'hand'?")));
}

TEST_F(Program, RefusesABaseLinkThatDoesNotExist) {
  spoil("c.yaml", "base_link: base_link", "base_link: bsae_link");
  expect_refused(AllOf(HasSubstr("'bsae_link'"), HasSubstr("did you mean 'base_link'?")));
}

TEST_F(Program, RefusesAFloatingJointOnTheWayWithoutItsPoseByName) {
  spoil("tiny.urdf", "<joint name=\"mast_joint\" type=\"fixed\">",
        "<joint name=\"mast_joint\" type=\"floating\">");
  expect_refused(HasSubstr("the pose of floating joint 'mast_joint' is not in the sample"));
}

TEST_F(Program, RefusesAFreeParameterThatDoesNotExist) {
  spoil("c.yaml", "camera_z_offset", "camera_xy");
  expect_refused(
      HasSubstr("c.yaml:11: free parameter 'camera_xy' is neither a joint of the robot "
                "nor a parameter of a joint, sensor or error block; did you mean "
                "'camera_"));
}

TEST_F(Program, WarnsOfAFixedJointAsAnOffset) {
  spoil("c.yaml", " - elbow", " - optical_joint\n - elbow");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, AllOf(HasSubstr("c.yaml:10:"), HasSubstr("'optical_joint' is fixed")));
}

TEST_F(Program, RefusesAMisspeltFreeFrame) {
  spoil("c.yaml", "name: mast_joint", "name: mast_jiont");
  expect_refused(AllOf(HasSubstr("c.yaml:13:"), HasSubstr("did you mean 'mast_joint'?")));
}

TEST_F(Program, RefusesALinkAsAFreeFrameAndNamesItsJoint) {
  spoil("c.yaml", "name: mast_joint", "name: mast");
  expect_refused(AllOf(HasSubstr("'mast' is a link"), HasSubstr("'mast_joint'")));
}

TEST_F(Program, RefusesAnUnknownModelInABlock) {
  spoil("c.yaml", "model_a: camera", "model_a: camra");
  expect_refused(AllOf(HasSubstr("c.yaml:15: error block 'hand_eye': model_a 'camra'"),
                       HasSubstr("did you mean 'camera'?")));
}

TEST_F(Program, RefusesAnUnknownBlockType) {
  spoil("c.yaml", "type: chain3d_to_chain3d", "type: chain3d_to_chain");
  expect_refused(
      AllOf(HasSubstr("'chain3d_to_chain'"), HasSubstr("did you mean 'chain3d_to_chain3d'?")));
}

TEST_F(Program, RefusesAnUnknownModelType) {
  spoil("c.yaml", "type: camera3d", "type: camera4d");
  expect_refused(AllOf(HasSubstr("c.yaml:7: model 'camera'"), HasSubstr("'camera4d'"),
                       HasSubstr("did you mean 'camera3d'?"), Not(HasSubstr("z_offset"))));
}

TEST_F(Program, RefusesAModelAndAFrameOfOneNameInTheRos2Dialect) {
  write("c.yaml", R"(robot_calibration:
  ros__parameters:
    base_link: base_link
    calibration_steps: [one]
    one:
      models: [arm, camera]
      arm: {type: chain3d, frame: hand}
      camera: {type: camera3d, frame: camera_optical_frame}
      free_params: [elbow]
      free_frames: [arm]
      error_blocks: [hand_eye]
      hand_eye: {type: chain3d_to_chain3d, model_a: camera, model_b: arm}
)");
  expect_refused(AllOf(HasSubstr("c.yaml:"), HasSubstr("'arm'"), HasSubstr("rename")));
}

TEST_F(Program, RefusesWhatIsNotYaml) {
  write("c.yaml", "models: [a, {b: c\n");
  expect_refused(HasSubstr("c.yaml:"));
}

TEST_F(Program, RefusesACharacterThatCannotBeginADocumentWithoutHanging) {
  for (const char* text : {",", "--- ,", "a: 1\n---\n,"}) {
    write("c.yaml", text);
    expect_refused(HasSubstr("c.yaml:"));
  }
  write("c.yaml", kConfig);
  write("s.yaml", ",");
  expect_refused(HasSubstr("s.yaml:"));
}

TEST_F(Program, RefusesASampleWithoutAJointThatAChainNeeds) {
  auto all = samples();
  all[4].joint_names[1] = "elbw";
  write_all(all);
  expect_refused(AllOf(HasSubstr("s.yaml:"), HasSubstr("joint 'elbow' is not in the sample"),
                       HasSubstr("did you mean 'elbw'?")));
}

TEST_F(Program, LeavesOutFeaturesThatAreNotNumbersWithACount) {
  auto all = samples();
  all[2].observations[0].features[1].point.y() = std::nan("");
  all[5].observations[1].features[0].point.x() = HUGE_VAL;
  write_all(all);
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err,
              AllOf(HasSubstr("2 features are not numbers and left out"), HasSubstr("s.yaml:")));
  EXPECT_EQ(
      YAML::LoadFile((folder_ / "out/report.json").string())["error_blocks"][0]["count"].as<int>(),
      58);
}

TEST_F(Program, SaysWhichSamplesHaveNoFeatureInCommon) {
  auto all = samples();
  for (std::size_t n = 0; n < all.size(); ++n) {
    for (Observation& seen : all[n].observations) {
      const int first = n < 2 && seen.sensor == "arm" ? 10 : 0;
      for (std::size_t i = 0; i < seen.features.size(); ++i) {
        seen.features[i].id = first + static_cast<int>(i);
      }
    }
  }
  write_all(all);
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("error block 'hand_eye' does not use 2 samples: its sensors "
                                    "observed no feature of the same id; the first is at "));
}

TEST_F(Program, RefusesSamplesInWhichNoFeatureIsANumber) {
  auto all = samples();
  for (Sample& sample : all) {
    for (Feature& f : sample.observations[0].features) f.point.y() = std::nan("");
  }
  write_all(all);
  expect_refused(HasSubstr("no sample has usable features"));
}

TEST_F(Program, RefusesTwoSensorsWithDifferentFeatureCounts) {
  auto all = samples();
  all[6].observations[1].features.pop_back();
  write_all(all);
  expect_refused(AllOf(HasSubstr("s.yaml:"), HasSubstr("sensor 'camera' has 3 features"),
                       HasSubstr("sensor 'arm' has 2")));
}

TEST_F(Program, RefusesZeroSamples) {
  write("s.yaml", "");
  expect_refused(AllOf(HasSubstr("s.yaml"), HasSubstr("no samples")));
}

TEST_F(Program, RefusesACameraWithoutCameraInfo) {
  auto all = samples();
  all[1].observations[0].camera.reset();
  write_all(all);
  expect_refused(AllOf(HasSubstr("s.yaml:"), HasSubstr("'camera'"), HasSubstr("camera_info")));
}

TEST_F(Program, RefusesAProjectionMatrixOfTheWrongSize) {
  std::string text = read("s.yaml");
  const auto p = text.find("P: [");
  ASSERT_NE(p, std::string::npos);
  text.replace(p, text.find(']', p) + 1 - p, "P: [550.0, 0.0, 320.0]");
  write("s.yaml", text);
  expect_refused(AllOf(HasSubstr("s.yaml:"), HasSubstr("P"), HasSubstr("12")));
}

TEST_F(Program, RefusesAPointBehindTheCamera) {
  auto all = samples();
  all[8].observations[0].features[2].point.z() = -0.7;
  write_all(all);
  expect_refused(AllOf(HasSubstr("s.yaml:"), HasSubstr("behind the camera")));
}

TEST_F(Program, RefusesAFeatureInAnUnknownFrame) {
  auto all = samples();
  all[8].observations[1].features[2].frame = "hnad";
  write_all(all);
  expect_refused(
      AllOf(HasSubstr("s.yaml:"), HasSubstr("'hnad'"), HasSubstr("did you mean 'hand'")));
}

TEST_F(Program, RefusesASampleFileThatWasCutOff) {
  const std::string text = read("s.yaml");
  write("s.yaml", text.substr(0, text.size() - 100));
  expect_refused(HasSubstr("s.yaml:"));
}

TEST_F(Program, RefusesAnOutputFolderThatIsAFile) {
  write("out", "precious");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("out"));
  EXPECT_EQ(read("out"), "precious");
}

TEST_F(Program, RefusesAnOutputFolderThatCannotBeCreated) {
  const Outcome result =
      run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --output /proc/kinecal/out");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("/proc/kinecal/out"));
}

/// A disk that is full half way: no file may grow beyond 2 kB, less than the URDF.
TEST_F(Program, WritesNothingWhenTheDiskIsFullHalfWay) {
  ASSERT_EQ(calibrate().code, 0);
  const std::string before = read("out/calibrated.urdf");
  ASSERT_GT(before.size(), 1024u);
  spoil("tiny.urdf", "0.4 0 0", "0.41 0 0");
  const std::string command = "cd " + folder_.string() + " && (trap '' XFSZ; ulimit -f 1; " +
                              test::kinecal_program() +
                              " calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml "
                              "--output out --force > /dev/null 2>&1)";
  const int status = std::system(command.c_str());
  EXPECT_EQ(WEXITSTATUS(status), 1);
  EXPECT_EQ(read("out/calibrated.urdf"), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 8) << "left something";
}

TEST_F(Program, RefusesToReplaceItsInput) {
  fs::rename(folder_ / "c.yaml", folder_ / "calibration.yaml");
  const Outcome result =
      run("calibrate --urdf tiny.urdf --config calibration.yaml --samples s.yaml --output .");
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("calibration.yaml: would replace an input"));
  EXPECT_EQ(read("calibration.yaml"), kConfig);
  EXPECT_FALSE(fs::exists(folder_ / "calibrated.urdf"));
}

TEST_F(Program, RefusesToReplaceAFolder) {
  fs::create_directories(folder_ / "out/calibrated.urdf");
  write("out/calibrated.urdf/precious", "x");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 1);
  EXPECT_THAT(result.err, HasSubstr("out/calibrated.urdf: exists and is not a file"));
  EXPECT_EQ(read("out/calibrated.urdf/precious"), "x");
}

TEST_F(Program, RemovesTheFoldersItMadeWhenItDoesNotConverge) {
  write("c.yaml", std::string(kConfig) + "max_num_iterations: 1\n");
  EXPECT_EQ(run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --output a/b/c").code,
            2);
  EXPECT_FALSE(fs::exists(folder_ / "a"));
}

TEST_F(Program, ReadsTheUrdfFromAPipe) {
  const std::string command = "cd " + folder_.string() + " && cat tiny.urdf | " +
                              test::kinecal_program() +
                              " calibrate --urdf /dev/stdin --config c.yaml --samples s.yaml "
                              "--output out > /dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
  EXPECT_TRUE(fs::exists(folder_ / "out/calibrated.urdf"));
}

/// What follows `--hold` in a text.
std::string to_hold(const std::string& text) {
  const std::size_t at = text.find("--hold");
  return at > text.size() ? "" : text.substr(at, text.find('\n', at) - at);
}

TEST_F(Program, SaysWhatCannotBeDeterminedAndHoldsIt) {
  spoil("c.yaml", " - elbow", " - elbow\n - shoulder");
  const Outcome result = calibrate();  // the shoulder turns about the same axis as the mast's yaw
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("1 of 9 parameters cannot be determined"),
                                HasSubstr("shoulder"), HasSubstr("mast_joint_")));
  const std::string hold = to_hold(result.out);
  EXPECT_EQ(to_hold(check().out), hold);
  const Outcome held = calibrate(hold + " --verbose");
  EXPECT_EQ(held.code, 0) << held.err;
  EXPECT_THAT(held.out, Not(HasSubstr("cannot be determined")));
  EXPECT_THAT(held.out, HasSubstr("calibrate: 8 parameters"));
  EXPECT_THAT(check(hold).out, Not(HasSubstr("cannot be determined")));
  EXPECT_THAT(calibrate("--dry-run --hold elbwo").err,
              HasSubstr("--hold elbwo: no step frees it; did you mean 'elbow'?"));
}

TEST_F(Program, RefusesFewerResidualsThanParameters) {
  auto all = samples();
  all.resize(1);
  for (Observation& seen : all[0].observations) seen.features.resize(2);
  write_all(all);
  expect_refused(AllOf(HasSubstr("8 free parameters"), HasSubstr("gives only 6 residuals")));
}

TEST_F(Program, WarnsOfAParameterThatEndedAtItsBound) {
  write("c.yaml", std::string(kConfig) + "bounds: {elbow: [-0.5, 0.01]}\n");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("'elbow' ended at its bound 0.573 deg"));
}

TEST_F(Program, InitialValuesOfALaterStepDoNotTouchAnEarlierOne) {
  write("c.yaml", R"(base_link: base_link
models:
 - {name: arm, type: chain, frame: hand}
 - {name: camera, type: camera3d, frame: camera_optical_frame}
error_blocks:
 - {name: hand_eye, type: chain3d_to_chain3d, model_a: camera, model_b: arm}
cal_steps:
  a:
    free_params: [elbow]
  b:
    free_params: []
    free_frames:
     - {name: mast_joint, x: true, y: true, z: true}
    initial_values: {mast_joint_x: 0.1}
)");
  const Outcome result = calibrate();
  EXPECT_EQ(result.code, 0) << result.err;
  const YAML::Node steps = YAML::LoadFile((folder_ / "out/report.json").string())["steps"];
  ASSERT_EQ(steps.size(), 2u);
  EXPECT_LT(steps[0]["final_cost"].as<double>(), 1e-20);
  EXPECT_GT(steps[1]["initial_cost"].as<double>(), 0.1);
}

TEST_F(Program, StartingAtTheResultConverges) {
  ASSERT_EQ(calibrate().code, 0);
  std::string values = "initial_values:\n";
  for (const auto& line : YAML::LoadFile((folder_ / "out/calibration.yaml").string())) {
    const auto name = line.first.as<std::string>();
    if (name.ends_with("_info") || name == "urdf") continue;
    values += "  " + name + ": " + line.second.as<std::string>() + "\n";
  }
  write("c.yaml", kConfig + values);
  EXPECT_EQ(calibrate().code, 0);
}

TEST_F(Program, RefusesAJointNamedLikeAParameterOfAFrame) {
  std::string text = kUrdf;
  for (const char* where : {"\"elbow\""}) {
    text.replace(text.find(where), std::string(where).size(), "\"mast_joint_x\"");
  }
  write("tiny.urdf", text);
  spoil("c.yaml", " - elbow\n", "");
  auto all = samples();
  for (Sample& sample : all) sample.joint_names[1] = "mast_joint_x";
  write_all(all);
  expect_refused(AllOf(HasSubstr("c.yaml:"), HasSubstr("parameter 'mast_joint_x' of frame"),
                       HasSubstr("rename")));
}

TEST_F(Program, TakesTheFirstPositionOfAJointThatASampleNamesTwice) {
  const test::Outcome once = calibrate();
  const std::string expected = read("out/calibration.yaml");
  auto all = samples();
  for (Sample& sample : all) {
    sample.joint_names.push_back("elbow");
    sample.joint_positions.push_back(*sample.position("elbow"));
  }
  write_all(all);
  const test::Outcome twice = calibrate();
  EXPECT_EQ(twice.code, 0);
  EXPECT_EQ(twice.err, once.err);
  EXPECT_EQ(read("out/calibration.yaml"), expected);
  all[3].joint_positions.back() += 0.5;
  write_all(all);
  const test::Outcome other = calibrate();
  EXPECT_EQ(other.code, 0);
  EXPECT_THAT(other.err, AllOf(HasSubstr("1 joint of a sample has a second position that differs"),
                               HasSubstr("joint 'elbow' at")));
  EXPECT_EQ(read("out/calibration.yaml"), expected);
}

/// Samples of the hand, and samples of the floor as old recordings hold them: the camera's points and
/// an observation of "ground".
std::vector<Sample> samples_with_ground() {
  std::vector<Sample> all = samples();
  const Robot robot = parse_urdf(kUrdf, "tiny.urdf");
  const RuntimeChain camera = make_chain(robot, "base_link", "camera_optical_frame");
  const Pose<double> camera_T_base =
      forward_kinematics(camera, [](const std::string&) { return 0.0; }).inverse();
  for (int n = 0; n < 4; ++n) {
    Sample sample = all[static_cast<std::size_t>(n)];
    Observation &seen = sample.observations[0], &ground = sample.observations[1];
    seen.features.clear();
    for (int i = 0; i < 5; ++i) {
      const Vector3<double> p = camera_T_base * Vector3<double>(1.0 + 0.1 * i * n, 0.2 * i, 0.0);
      seen.features.push_back({"camera_optical_frame", p});
    }
    ground = {"ground", {{"base_link", Vector3<double>::Zero()}}};
    all.push_back(sample);
  }
  return all;
}

TEST_F(Program, TakesOnlySamplesOfTheGroundForAGroundThatTheBlockNames) {
  write_all(samples_with_ground());
  const std::string block = " - {name: floor, type: camera3d_to_ground, camera: camera, ground: ";
  for (const char* more : {"ground}\n", "ground, samples: alone}\n"}) {
    write("c.yaml", kConfig + block + more);
    const Outcome result = calibrate();
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_THAT(result.err, Not(HasSubstr("floor")));
    const YAML::Node report = YAML::LoadFile((folder_ / "out/report.json").string());
    EXPECT_EQ(report["error_blocks"][0]["count"].as<int>(), 60);
    EXPECT_EQ(report["error_blocks"][1]["count"].as<int>(), 20) << result.out;
    EXPECT_NEAR(YAML::LoadFile((folder_ / "out/calibration.yaml").string())["elbow"].as<double>(),
                0.02, 1e-9);
  }
  write("c.yaml", kConfig + block + "grund}\n");
  EXPECT_THAT(calibrate().err,
              HasSubstr("none has a sensor 'grund', which its key 'ground' names; did you mean "
                        "'ground'?"));
}

TEST_F(Program, RefusesADistortionModelItDoesNotKnow) {
  spoil("c.yaml", "type: camera3d", "type: camera2d");
  spoil("c.yaml", " - camera_z_offset\n", "");
  spoil("c.yaml", "type: chain3d_to_chain3d\n   model_a: camera\n   model_b: arm",
        "type: chain3d_to_camera2d\n   model_3d: arm\n   model_2d: camera");
  auto all = samples();
  for (Sample& sample : all) {
    sample.observations[0].camera->distortion_model = "bowl";
    sample.observations[0].camera->d = {0.1, 0.0, 0.0, 0.0};
  }
  write_all(all);
  expect_refused(AllOf(HasSubstr("c.yaml:6"), HasSubstr("distortion model 'bowl'")));
}

TEST_F(Program, AnObservationWithoutFeaturesDoesNotCount) {
  auto all = samples();
  all[2].observations[1].features.clear();
  write_all(all);
  EXPECT_EQ(calibrate().code, 0);
}

TEST_F(Program, WarnsOfACameraThatWasSetDifferently) {
  auto all = samples();
  all[9].observations[0].camera->p[0] = 551.0;
  write_all(all);
  const Outcome result = calibrate();
  EXPECT_THAT(result.err, AllOf(HasSubstr("s.yaml:"), HasSubstr("'camera' differs")));
}

TEST_F(Program, WarnsOfPointsThatAreNotInMetres) {
  auto all = samples();
  EXPECT_THAT(calibrate("--dry-run").err, Not(HasSubstr("metres")));
  for (Feature& feature : all[3].observations[0].features) feature.point *= 1000.0;
  write_all(all);
  EXPECT_THAT(run("check --urdf tiny.urdf --config c.yaml --samples s.yaml").err,
              AllOf(HasSubstr("3 points are more than 100 m away"), HasSubstr("s.yaml:"),
                    HasSubstr("sensor 'camera', ")));
}

TEST_F(Program, WritesNoCameraThatCannotBe) {
  for (const std::string& found : {std::string("fx: -2.0"), std::string("z_scaling: -1.5")}) {
    write("c.yaml", kConfig + ("initial_values: {camera_" + found + "}\n"));
    const Outcome result = calibrate();
    EXPECT_EQ(result.code, 2) << result.out;
    EXPECT_THAT(result.err,
                AllOf(HasSubstr("calibration of step 'calibrate' failed, no results written"),
                      HasSubstr("camera 'camera': ")));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  }
}

TEST_F(Program, ACameraFileThatIsThereIsReplacedOnlyIfForced) {
  ASSERT_EQ(calibrate().code, 0);
  write("mine.yaml", "mine");
  const Outcome refused = run("camera out/rgb_camera.yaml --output mine.yaml");
  EXPECT_EQ(refused.code, 1);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("error: mine.yaml: exists"), HasSubstr("--force")));
  EXPECT_EQ(read("mine.yaml"), "mine");
  EXPECT_EQ(run("camera out/rgb_camera.yaml --output mine.yaml --force").code, 0);
  EXPECT_THAT(read("mine.yaml"), HasSubstr("camera_matrix:"));
}

TEST_F(Program, ReportsWhereTheBaseIsMisspeltOrMissing) {
  spoil("c.yaml", "base_link: base_link", "base_link: base_lnk");
  expect_refused(AllOf(HasSubstr("c.yaml:1: base_link: no link 'base_lnk'"),
                       HasSubstr("did you mean 'base_link'?")));
  spoil("c.yaml", "base_link: base_lnk\n", "");
  std::string text = kUrdf;
  for (std::size_t at; (at = text.find("\"base_link\"")) != std::string::npos;) {
    text.replace(at, 11, "\"root\"");
  }
  write("tiny.urdf", text);
  expect_refused(HasSubstr("c.yaml: base_link is not given: no link 'base_link' in robot 'tiny'"));
}

TEST_F(Program, RefusesAFolderWhereAFileIsMeant) {
  fs::create_directory(folder_ / "folder");
  EXPECT_THAT(run("check --urdf tiny.urdf --config folder").err,
              HasSubstr("folder: is a folder, not a file"));
  EXPECT_THAT(run("check --urdf folder --config c.yaml").err, HasSubstr("folder: is a folder"));
}

TEST_F(Program, ListsTheCommandsIfOneIsMisspelt) {
  const Outcome misspelt = run("calibrat --urdf tiny.urdf");
  EXPECT_EQ(misspelt.code, 1);
  EXPECT_THAT(misspelt.err, HasSubstr("error: 'calibrat' is not a command; did you mean "
                                      "'calibrate'?"));
  EXPECT_THAT(run("''").err, HasSubstr("error: no command is given; use one of init, "));
  EXPECT_THAT(
      run("check --config c.yaml --urfd x").err,
      AllOf(HasSubstr("error: "), HasSubstr("--urfd"), HasSubstr("'kinecal check --help'")));
  EXPECT_THAT(run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml").err,
              HasSubstr("error: --output is required"));
  const Outcome help = run("--help");
  for (const char* command :
       {"init", "check", "calibrate", "install", "inspect", "convert", "camera", "rpy"}) {
    EXPECT_THAT(help.out, HasSubstr("  " + std::string(command) + " "));
    EXPECT_THAT(run(std::string(command) + " --help").out,
                HasSubstr("Usage: kinecal " + std::string(command)));
  }
}

TEST_F(Program, RefusesUnknownOptionsWithExitCode1) {
  EXPECT_EQ(run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml").code, 1);
  EXPECT_EQ(run("calibrate --urdf tiny.urdf --config c.yaml --samples s.yaml --dry-run").code, 0);

  EXPECT_EQ(run("calibrate --urfd tiny.urdf").code, 1);
  EXPECT_EQ(run("").code, 0) << "its help";
  EXPECT_EQ(run("--help").code, 0);
}

}  // namespace
}  // namespace kinecal
