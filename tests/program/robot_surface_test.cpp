// The robot as its own target, from files to files: clouds and masks.  With the program as installed, sums cross the border
// to the library of an instruction set here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>

#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/samples/write_samples.hpp"
#include "support/mask_robot.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::Outcome;
using testing::HasSubstr;

class RobotSurfaceProgram : public test::ProgramTest {
 protected:
  RobotSurfaceProgram() {
    test::write_meshes(folder_);
    std::ofstream(folder_ / "arm.urdf") << test::mesh_robot_urdf();
  }
  /// Calibrates samples; the pose of the camera is unknown.
  Outcome calibrate(const std::vector<Sample>& samples, const std::string& config) {
    std::ofstream file(folder_ / "samples.yaml");
    write_samples(file, samples);
    file.close();
    std::ofstream(folder_ / "calibrate.yaml") << config;
    return kinecal(
        "calibrate --urdf arm.urdf --config calibrate.yaml --samples samples.yaml --output out");
  }

  Robot robot_ = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
};

TEST_F(RobotSurfaceProgram, CalibratesByClouds) {
  const Outcome result = calibrate(test::mesh_robot_samples(robot_, {.samples = 5, .noise = 0.001}),
                                   test::mesh_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("'camera_joint' was searched"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/calibrated.urdf"));
}

TEST_F(RobotSurfaceProgram, VerifiesByNewClouds) {
  const Outcome result = calibrate(test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001}),
                                   test::mesh_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  std::vector<Sample> later =
      test::mesh_robot_samples(robot_, {.samples = 6, .noise = 0.001, .seed = 7});
  const auto verify = [&] {
    std::ofstream file(folder_ / "later.yaml");
    write_samples(file, later);
    file.close();
    return kinecal("verify out later.yaml --report verify.json");
  };
  const Outcome same = verify();
  EXPECT_EQ(same.code, 0) << same.out << same.err;
  EXPECT_THAT(same.out, HasSubstr("verdict: holds"));
  for (Sample& sample : later) {  // the camera was knocked: 8 mm to its right
    for (Feature& point : sample.observations.at(0).features) point.point.x() -= 0.008;
  }
  const Outcome knocked = verify();
  EXPECT_EQ(knocked.code, 2) << knocked.out << knocked.err;
  EXPECT_THAT(knocked.out, HasSubstr("verdict: does not hold"));
  EXPECT_THAT(knocked.out, testing::ContainsRegex("'camera_joint' by [78]\\.[0-9]+ mm \\+- 0\\."));
  EXPECT_THAT(knocked.out, HasSubstr("see whether 'camera_joint' is loose"));
}

TEST_F(RobotSurfaceProgram, CalibratesByMasks) {
  const Outcome result = calibrate(test::mask_robot_samples(robot_, {.samples = 6, .pixels = 2}),
                                   test::mask_config(""));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("'camera_joint' was searched"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/calibrated.urdf"));
}

/// Simulates robots, and calibrates with the commands that the simulation prints.
class SimulatedRobotSurface : public test::ProgramTest {
 protected:
  /// @param scene  lines of it
  void simulate(const std::string& urdf, const std::string& scene) {
    std::ofstream(folder_ / "camera_info.yaml")
        << to_camera_info_yaml(test::mask_camera(), "camera");
    std::ofstream(folder_ / "scene.yaml")
        << "target: {type: robot}\nerrors: {joint: 0.05, position: 0.02, rotation: 0.05}\n"
        << scene;
    const Outcome made = kinecal("simulate " + urdf + " --scene scene.yaml -o sim");
    ASSERT_EQ(made.code, 0) << made.err;
    const std::size_t next = made.out.find("next: ");
    ASSERT_NE(next, std::string::npos) << made.out;
    const std::string command = made.out.substr(next + 6);
    const std::string path = std::filesystem::path(test::kinecal_program()).parent_path().string();
    calibrated_ =
        run("(export PATH=" + path + ":$PATH; " + command.substr(0, command.find('\n')) + ")");
  }
  /// The result, within its uncertainty of the truth.
  void expect_truth() {
    ASSERT_EQ(calibrated_.code, 0) << calibrated_.out << calibrated_.err;
    const YAML::Node truth = YAML::LoadFile((folder_ / "sim/truth.yaml").string());
    const YAML::Node report = YAML::LoadFile((folder_ / "calibrated/report.json").string());
    EXPECT_EQ(report["verdict"].as<std::string>(), "good") << calibrated_.out << calibrated_.err;
    EXPECT_EQ(report["left_out"].size(), 0U);
    int compared = 0;
    double worst_error = 0.0;
    for (const YAML::Node& parameter : report["parameters"]) {
      const std::string name = parameter["name"].as<std::string>();
      const double sigma = parameter["sigma"].as<double>();
      const double error = std::abs(parameter["value"].as<double>() - truth[name].as<double>());
      constexpr double kSigmas = 4.0, kRounding = 2e-4;  // of a few poses; of backlash, rad and m
      EXPECT_LT(error, kSigmas * sigma + kRounding) << name;
      worst_error = std::max(worst_error, error);
      ++compared;
    }
    EXPECT_GE(compared, 8);
    constexpr double kAtLeastDrawn = 0.01;  // half of the smallest kind of error
    EXPECT_LT(worst_error, 0.5 * kAtLeastDrawn) << "errors are found, not only their uncertainty";
  }

  Outcome calibrated_;
};

/// The arm with a camera that stands where the URDF says.
std::string watched_arm() {
  std::string urdf = test::mesh_robot_urdf();
  const std::string joint = "<child link=\"camera\"/>";
  urdf.insert(urdf.find(joint), "<origin xyz=\"-1.3 -0.6 0.75\" rpy=\"-1.7 0.1 -1.2\"/>");
  return urdf;
}

TEST_F(SimulatedRobotSurface, CloudsGiveItsErrors) {
  test::write_meshes(folder_);
  std::ofstream(folder_ / "arm.urdf") << watched_arm();
  simulate("arm.urdf", "camera: {info: camera_info.yaml}\nposes: 8\n");
  expect_truth();
}

TEST_F(SimulatedRobotSurface, MasksGiveItsErrors) {
  std::filesystem::create_directories(folder_ / "robots/arm/meshes");
  test::write_meshes(folder_ / "robots/arm/meshes");
  std::string urdf = watched_arm();
  for (std::size_t at = 0; (at = urdf.find("filename=\"", at)) != std::string::npos; at += 10) {
    urdf.insert(at + 10, "package://arm/meshes/");
  }
  std::ofstream(folder_ / "arm.urdf") << urdf;
  const Outcome lost = kinecal("simulate arm.urdf --target robot -o sim");
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.err, HasSubstr("package 'arm', which was not found"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
  simulate("arm.urdf --mesh-path robots",
           "camera: {info: camera_info.yaml, type: camera2d}\nposes: 12\n");
  expect_truth();
}

TEST_F(SimulatedRobotSurface, ACameraWithoutAPoseIsRefused) {
  test::write_meshes(folder_);
  std::ofstream(folder_ / "arm.urdf") << test::mesh_robot_urdf();
  const Outcome lost = kinecal("simulate arm.urdf --target robot -o sim");
  EXPECT_EQ(lost.code, 1);
  EXPECT_THAT(lost.err, HasSubstr("the URDF has the camera 'camera' in the origin of 'base'"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
}

TEST_F(SimulatedRobotSurface, ARobotWithoutSurfaceIsRefused) {
  const Outcome bare = kinecal("simulate " + test::source_folder() +
                               "/examples/robots/ubr1/ubr1.urdf --target robot -o sim");
  EXPECT_EQ(bare.code, 1);
  EXPECT_THAT(bare.err, HasSubstr("error: --target: no link has a mesh or shape in a <visual>"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "sim"));
}

TEST_F(SimulatedRobotSurface, SessionsHaveOtherTargets) {
  const std::string fetch = test::source_folder() + "/examples/robots/fetch/fetch.urdf";
  ASSERT_EQ(kinecal("simulate " + fetch + " --target leds --poses 3 -o sim").code, 0);
  std::ofstream(folder_ / "robot.yaml") << "target: {type: robot}\n";
  const Outcome session = kinecal("capture sim/capture.yaml --urdf " + fetch +
                                  " --poses sim/poses.yaml --robot simulated:robot.yaml -o s.yaml");
  EXPECT_EQ(session.code, 1);
  EXPECT_THAT(session.err, HasSubstr("target 'robot' is simulated by 'kinecal simulate'"));
}

}  // namespace
}  // namespace kinecal
