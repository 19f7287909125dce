// A mobile base by a configuration: wheels, odometry and gyroscope as other error blocks are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/results/base_file.hpp"
#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/procedure/calibrated_files.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/study/simulated_base.hpp"
#include "support/robots.hpp"
#include "support/wrong_base.hpp"

namespace kinecal {
namespace {

using test::wrong_base;
using testing::HasSubstr;
using testing::IsEmpty;

/// @param blocks  "{name: base, type: ...}", in lines
CalibrationSetup setup_of(const std::string& free, const std::string& blocks,
                          std::vector<Sample> samples) {
  Diagnostics found;
  CalibrationSetup setup{.robot = test::mobile_manipulator(),
                         .config = parse_config("base_link: base_link\nmodels: []\nfree_params: [" +
                                                    free + "]\nerror_blocks:\n" + blocks,
                                                "base.yaml", found)};
  EXPECT_THAT(found.errors, IsEmpty());
  setup.samples = std::move(samples);
  return setup;
}

/// Expects a parameter within four standard deviations of the truth, which are below 0.6 %: a third of its errors.
void expect_found(const CalibratedRobot& calibrated, const std::string& name, double truth) {
  const int index = calibrated.result.table.index(name);
  const std::optional<double> deviation = calibrated.deviation(index);
  ASSERT_TRUE(deviation) << name;
  EXPECT_LT(*deviation, 0.006) << name;
  EXPECT_NEAR(calibrated.result.table[index].value, truth, 4.0 * *deviation) << name;
}

TEST(CalibrateBase, ByAWallAsBaseCalibrationDoes) {
  const CalibratedRobot calibrated =
      calibrate_robot(setup_of("base_track_width_scale, base_rollout_scale, imu_scale, imu_bias",
                               "- {name: base, type: odometry_to_wall, x: 0.23, translation_scale: "
                               "500, rotation_scale: 500}\n"
                               "- {name: imu, type: gyro_to_wall}\n",
                               simulate_base(wrong_base(), turns_and_straight_runs(), 5).samples));
  ASSERT_TRUE(calibrated.result.converged);
  expect_found(calibrated, "base_track_width_scale", 1.02);
  expect_found(calibrated, "base_rollout_scale", 0.98);
  expect_found(calibrated, "imu_scale", 0.98);
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good);
}

TEST(CalibrateBase, ByATrackedPoseWithTheMountOfTheLaser) {
  SimulatedBase base = wrong_base();
  base.left_rollout_scale = 0.99;
  base.mount = {0.25, 0.01, 0.02};
  PreparedCalibration prepared = prepare(setup_of(
      "base_track_width_scale, base_left_rollout_scale, base_right_rollout_scale, base_x, base_y, "
      "base_yaw",
      "- {name: base, type: differential_to_pose, wheel_radius: 0.0605, track_width: 0.37476, x: "
      "0.2, translation_scale: 500, rotation_scale: 500}\n",
      simulate_base(base, all_runs(), 6).samples));
  EXPECT_THAT(prepared.diagnostics.warnings, IsEmpty());
  const CalibratedRobot calibrated = calibrate_robot(std::move(prepared));
  ASSERT_TRUE(calibrated.result.converged);
  expect_found(calibrated, "base_track_width_scale", 1.02);
  expect_found(calibrated, "base_left_rollout_scale", 0.99);
  expect_found(calibrated, "base_right_rollout_scale", 0.98);
  expect_found(calibrated, "base_x", 0.25);
  expect_found(calibrated, "base_y", 0.01);
  expect_found(calibrated, "base_yaw", 0.02);
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good);
}

/// Under upstream's keys.
TEST(CalibrateBase, TheFileHasUpstreamsKeys) {
  CalibratedRobot calibrated =
      calibrate_robot(setup_of("base_track_width_scale, base_rollout_scale, imu_scale",
                               "- {name: base, type: odometry_to_wall, x: 0.23, translation_scale: "
                               "500, rotation_scale: 500}\n"
                               "- {name: imu, type: gyro_to_wall}\n",
                               simulate_base(wrong_base(), turns_and_straight_runs(), 5).samples));
  EXPECT_EQ(calibrated.driver_file, "base_calibration.yaml");
  calibrated.result.table["base_track_width_scale"].value = 1.02;
  calibrated.result.table["base_rollout_scale"].value = 0.98;
  calibrated.result.table["imu_scale"].value = 0.975;
  const int rollout = calibrated.result.table.index("base_rollout_scale");
  EXPECT_EQ(base_calibration_yaml(calibrated.setup.calibration, calibrated.result.table,
                                  {{rollout, 0.00123}}),
            "track_width_scale: 1.02\nrollout_scale: 0.98  # +- 0.0012\nimu_scale: "
            "0.975\nimu_bias: 0.0\n");
  // And those of ROS 1, which Fetch's installer reads: what the driver should have.
  EXPECT_EQ(base_calibration_yaml(calibrated.setup.calibration, calibrated.result.table, {},
                                  {{"base", 0.37476}, {"imu", 0.001221729}}),
            "track_width_scale: 1.02\nrollout_scale: 0.98\nodom: 0.390056326531\nimu_scale: "
            "0.975\nimu_bias: 0.0\nimu: 0.001191185775\n");
}

TEST(CalibrateBase, WhatTheDriverHasIsOfTheConfiguration) {
  CalibrationSetup setup =
      setup_of("base_track_width_scale",
               "- {name: base, type: odometry_to_wall, x: 0.23, track_width: 0.37476, "
               "translation_scale: 500, rotation_scale: 500}\n",
               simulate_base(SimulatedBase{}, turns_and_straight_runs(), 5).samples);
  setup.urdf_text = "<robot name=\"r\"><link name=\"base_link\"/></robot>";
  std::string text;
  for (const OutputFile& file : calibrated_files(calibrate_robot(std::move(setup)))) {
    if (file.name == "base_calibration.yaml") text = file.content;
  }
  EXPECT_THAT(text, HasSubstr("\nodom: 0.37"));
}

/// Nobody sets a driver to a width of one metre that no file gives.
TEST(CalibrateBase, AWidthThatIsNotGivenIsNotThatOfTheDriver) {
  CalibrationSetup setup =
      setup_of("base_track_width_scale",
               "- {name: base, type: differential_to_wall, wheel_radius: 0.0605, x: 0.23, "
               "translation_scale: 500, rotation_scale: 500}\n",
               simulate_base(SimulatedBase{}, turns_and_straight_runs(), 5).samples);
  setup.urdf_text = "<robot name=\"r\"><link name=\"base_link\"/></robot>";
  std::string text;
  for (const OutputFile& file : calibrated_files(calibrate_robot(std::move(setup)))) {
    if (file.name == "base_calibration.yaml") text = file.content;
  }
  EXPECT_THAT(text, HasSubstr("track_width_scale: 0.37"));  // of one metre
  EXPECT_THAT(text, testing::Not(HasSubstr("odom:")));
}

constexpr const char* kWheelsAndGyro =
    "- {name: base, type: differential_to_pose, wheel_radius: 0.0605, track_width: 0.37476, x: "
    "0.2, translation_scale: 500, rotation_scale: 500}\n"
    "- {name: imu, type: gyro_to_pose}\n";
constexpr const char* kScales =
    "base_track_width_scale, base_left_rollout_scale, base_right_rollout_scale, imu_scale, "
    "imu_bias";

/// Turns alone determine the ratio of rollout and track width: neither is written.
TEST(CalibrateBase, WhatIsNotDeterminedIsNotWritten) {
  const std::vector<BaseRun> turns{{0.0, 0.5, 12.0}, {0.0, -0.5, 12.0}};
  CalibrationSetup setup =
      setup_of(kScales, kWheelsAndGyro, simulate_base(wrong_base(), turns, 6).samples);
  setup.urdf_text = "<robot name=\"r\"><link name=\"base_link\"/></robot>";
  const CalibratedRobot calibrated = calibrate_robot(std::move(setup));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::do_not_use);
  const int track = calibrated.result.table.index("base_track_width_scale");
  EXPECT_THAT(base_calibration_yaml(calibrated.setup.calibration, calibrated.result.table,
                                    {{track, std::numeric_limits<double>::infinity()}},
                                    {{"base", 0.37476}}),
              testing::AllOf(HasSubstr("# track_width_scale: not determined\n"),
                             testing::Not(HasSubstr("odom")), HasSubstr("imu_scale: ")));
}

/// An odometry that begins anew is one interval, which is left out; the result is as good as without it.
TEST(CalibrateBase, ARestartOfTheOdometryIsLeftOut) {
  std::vector<Sample> samples = simulate_base(wrong_base(), all_runs(), 6).samples;
  const std::size_t restart = samples.size() / 2 + 3;
  for (std::size_t i = restart; i < samples.size(); ++i) samples[i].conditions["odom_x"] += 5.0;
  const CalibratedRobot calibrated = calibrate_robot(setup_of(
      "base_track_width_scale, base_rollout_scale, base_x, base_y, base_yaw",
      "- {name: base, type: odometry_to_pose, translation_scale: 500, rotation_scale: 500}\n",
      samples));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::good);
  expect_found(calibrated, "base_track_width_scale", 1.02);
  expect_found(calibrated, "base_rollout_scale", 0.98);
  ASSERT_EQ(calibrated.left_out.size(), 1u);
  EXPECT_EQ(calibrated.left_out[0].source, samples[restart].source);
}

TEST(CalibrateBase, TwoRowsAreTooFew) {
  std::vector<Sample> samples = simulate_base(wrong_base(), all_runs(), 6).samples;
  samples.resize(2);
  const CalibratedRobot calibrated =
      calibrate_robot(setup_of("imu_bias", kWheelsAndGyro, std::move(samples)));
  EXPECT_EQ(calibrated.judgement.verdict, Grade::do_not_use);
  EXPECT_THAT(calibrated.judgement.reasons,
              testing::Contains(HasSubstr("'imu': 1 interval is too few to check 1 parameter")));
}

TEST(CalibrateBase, SizesArePositive) {
  Diagnostics found;
  (void)parse_config(
      "base_link: base_link\nmodels: []\nfree_params: [base_rollout_scale]\nerror_blocks:\n"
      "- {name: base, type: differential_to_pose, wheel_radius: 0}\n",
      "base.yaml", found);
  ASSERT_EQ(found.errors.size(), 1u);
  EXPECT_THAT(found.errors[0], HasSubstr("wheel_radius is not positive"));
}

TEST(CalibrateBase, ASampleOfAnotherRunIsNotTheOneBefore) {
  std::vector<Sample> samples =
      simulate_base(SimulatedBase{}, turns_and_straight_runs(), 1).samples;
  set_before(samples);
  int without = 0;
  for (const Sample& sample : samples) without += sample.before.empty() ? 1 : 0;
  EXPECT_EQ(without, static_cast<int>(turns_and_straight_runs().size()));
}

/// What is not a number does not count, and the sample before is the last in which it does.
TEST(CalibrateBase, ASampleWithoutTheWallIsSkipped) {
  std::vector<Sample> samples(3);
  const double kNone = std::numeric_limits<double>::quiet_NaN();
  samples[0].conditions = {{"odom_x", 1.0}, {"wall_angle", 0.1}};
  samples[1].conditions = {{"odom_x", 2.0}, {"wall_angle", kNone}};
  samples[2].conditions = {{"odom_x", 3.0}, {"wall_angle", 0.2}};
  set_before(samples, {"odom_x", "wall_angle"});
  EXPECT_EQ(samples[2].before.at("odom_x"), 1.0);
  set_before(samples, {"odom_x"});
  EXPECT_EQ(samples[2].before.at("odom_x"), 2.0);
}

}  // namespace
}  // namespace kinecal
