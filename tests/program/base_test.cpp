// A mobile base as its users meet it: simulated, configured, calibrated; and what they get wrong.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <string>

#include "support/paths.hpp"
#include "support/run_program.hpp"

namespace kinecal {
namespace {

using test::Outcome;
using testing::AllOf;
using testing::HasSubstr;

class BaseProgram : public test::ProgramTest {
 protected:
  /// The program does it.
  std::string done(const std::string& arguments) const {
    const Outcome outcome = kinecal(arguments);
    EXPECT_EQ(outcome.code, 0) << arguments << "\n" << outcome.out << outcome.err;
    return outcome.out;
  }
  void simulate() const {
    done("simulate " + test::source_folder() +
         "/examples/mobile_manipulator/mobile_manipulator.urdf --target base -o drive --seed 3");
  }
};

TEST_F(BaseProgram, ASimulatedDriveIsCalibrated) {
  constexpr double kGyroScale = 0.001221729;  // as --gyro-scale below
  simulate();
  EXPECT_THAT(done("init --target base --drive differential --urdf drive/robot.urdf --from "
                   "drive/drive.csv --wheel-radius 0.0605 "
                   "--gyro-scale 0.001221729 --output base.yaml"),
              AllOf(HasSubstr("wrote columns.yaml"),
                    HasSubstr("from the recording: differential and a gyroscope, a tracked pose"),
                    HasSubstr("next: kinecal convert drive/drive.csv samples.yaml --columns "
                              "columns.yaml && kinecal calibrate")));
  done("convert drive/drive.csv samples.yaml --columns columns.yaml");
  EXPECT_THAT(done("calibrate --urdf drive/robot.urdf --config base.yaml --samples samples.yaml "
                   "--output calibrated"),
              HasSubstr("it slipped"));
  done("verify calibrated samples.yaml");
  done("evaluate calibrated samples.yaml");
  const std::string file = read("calibrated/base_calibration.yaml");
  const YAML::Node truth = YAML::Load(read("drive/truth.yaml")), found = YAML::Load(file);
  const auto deviation = [&](const std::string& name) {  // "imu_scale: 0.98  # +- 0.0012"
    return std::stod(file.substr(file.find("+- ", file.find(name + ": ")) + 3));
  };
  for (const char* name :
       {"track_width_scale", "left_rollout_scale", "right_rollout_scale", "imu_scale"}) {
    const double is = truth[name].as<double>();
    EXPECT_GT(std::abs(is - 1.0), 1e-4) << name;
    EXPECT_LT(deviation(name), 0.003) << name << ": a fraction of errors of 2 %";
    EXPECT_NEAR(found[name].as<double>(), is, 4.0 * deviation(name)) << name;
  }
  EXPECT_NEAR(found["imu"].as<double>(), kGyroScale * truth["imu_scale"].as<double>(),
              kGyroScale * 4.0 * deviation("imu_scale"));
  EXPECT_TRUE(found["odom"]);
}

TEST_F(BaseProgram, WithoutAUrdfABaseAloneIsWritten) {
  simulate();
  done("init --target base --from drive/drive.csv --output base.yaml --seen wall");
  EXPECT_THAT(read("base.urdf"), HasSubstr("<link name=\"base_link\"/>"));
  EXPECT_THAT(read("base.yaml"), HasSubstr("type: odometry_to_wall"));
  EXPECT_THAT(read("columns.yaml"), HasSubstr("  odom_yaw: odom_yaw\n"));
  done("convert drive/drive.csv samples.yaml --columns columns.yaml");
  done("calibrate --urdf base.urdf --config base.yaml --samples samples.yaml --output calibrated");
}

TEST_F(BaseProgram, WhatIsMissingIsSaid) {
  write("t.csv", "enc_l,enc_r\n1,2\n2,3\n");
  EXPECT_THAT(kinecal("init --target base --from t.csv").err,
              HasSubstr("t.csv: no columns of what shows how the base moved"));
  write("t.csv", "enc_l,enc_r,x,y,yaw\n1,2,0,0,0\n2,3,0,0,0\n");
  const Outcome sizes = kinecal("init --target base --from t.csv");
  EXPECT_EQ(sizes.code, 1);
  EXPECT_THAT(sizes.err, HasSubstr("--wheel-radius is required: the URDF does not have it"));
  EXPECT_THAT(kinecal("init --target leds --track-width 1 --urdf r.urdf").err,
              HasSubstr("--track-width goes with --target base"));
  EXPECT_THAT(kinecal("init --target base,leds --from t.csv").err,
              HasSubstr("base does not go into one configuration with others"));
  EXPECT_THAT(kinecal("init --target base --from t.csv --drive tricycle --wheel-radius 1").err,
              HasSubstr("'tricycle' is not one of differential"));
  write("base.yaml",
        "base_link: base_link\nmodels: []\nfree_params: [base_rollout_scale]\n"
        "error_blocks: [{name: base, type: odometry_to_wall}]\n");
  write("r.urdf", "<robot name=\"r\"><link name=\"base_link\"/></robot>");
  EXPECT_THAT(kinecal("capture base.yaml --urdf r.urdf --robot ws://127.0.0.1:1 -o d.yaml").err,
              HasSubstr("d.yaml ends neither in .bag nor in .mcap"));
  EXPECT_THAT(kinecal("capture base.yaml --urdf r.urdf --robot ws://127.0.0.1:1 -o d.bag "
                      "--topic odm=/o")
                  .err,
              HasSubstr("'odm' is not a key; did you mean 'odom'?"));
}

}  // namespace
}  // namespace kinecal
