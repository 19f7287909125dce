// The robot as its own target, from files to files: clouds and masks.  With the program as installed, sums cross the border
// to the library of an instruction set here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

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

}  // namespace
}  // namespace kinecal
