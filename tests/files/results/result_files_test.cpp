#include "kinecal/files/results/result_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "kinecal/files/results/result_text.ipp"
#include "support/scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;

TEST(JointPatches, AreMadeOfOffsetsAndFrameCorrectionsOfTheRobotsJoints) {
  ParameterTable table = test::scene_table();
  table["elbow"].value = 0.02;
  table["camera_joint_x"].value = 0.01;
  table["camera_joint_c"].value = -0.03;
  table["board_x"].value = 0.5;  // a virtual frame, in no URDF
  const auto patches = joint_patches(test::mobile_manipulator(), table);
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(patches[0].joint, "elbow");
  EXPECT_EQ(patches[0].offset, 0.02);
  EXPECT_TRUE(patches[0].correction.rotation.isIdentity(0.0));
  EXPECT_EQ(patches[1].joint, "camera_joint");
  EXPECT_EQ(patches[1].correction.translation.x(), 0.01);
  EXPECT_LE((log(patches[1].correction.rotation) - Vector3<double>(0, 0, -0.03)).norm(), 1e-15);
}

TEST(JointPatches, HaveTheErrorsOfMimicJoints) {
  const Robot robot = test::mobile_manipulator();
  const auto mimic = std::find_if(robot.joints().begin(), robot.joints().end(),
                                  [](const Joint& joint) { return joint.mimic.has_value(); });
  ASSERT_NE(mimic, robot.joints().end());
  CalibrationResult result;
  result.table.add({.name = mimic->name + "_mimic_multiplier", .value = 0.125});
  result.table.add({.name = mimic->name + "_mimic_offset", .value = -0.5});
  const auto patches = joint_patches(robot, result.table);
  ASSERT_EQ(patches.size(), 1u);
  EXPECT_EQ(patches[0].joint, mimic->name);
  EXPECT_EQ(patches[0].mimic_multiplier, 0.125);
  EXPECT_EQ(patches[0].mimic_offset, -0.5);
  EXPECT_THAT(detail::values_yaml(robot, result, {}),
              HasSubstr("_mimic_offset: -0.5  # in <mimic> of the URDF\n"));
}

TEST(ResultFiles, CameraFilesAreNamedAsUpstreamNamesThem) {
  const std::string ours, upstream = "2026_01_02_03_04_05";  // no date, a date
  EXPECT_EQ(detail::camera_file("depth", "head", ours), "depth_head.yaml");
  EXPECT_EQ(detail::camera_file("depth", "camera", ours), "depth_camera.yaml");
  EXPECT_EQ(detail::camera_file("rgb", "head", upstream), "rgb_head_2026_01_02_03_04_05.yaml");
  EXPECT_EQ(detail::camera_file("rgb", "camera", upstream), "rgb_2026_01_02_03_04_05.yaml");
  EXPECT_EQ(detail::camera_file("rgb", "/head/camera", ours), "rgb__head_camera.yaml");
}

TEST(ResultFiles, ValuesAreThoseOfWhatWasCalibratedOrHeldAwayFromZero) {
  const Robot robot = test::mobile_manipulator();
  CalibrationResult result;
  result.table.add({.name = "elbow", .value = 0.1});
  result.table.add({.name = "wrist", .value = 0.0});
  result.table.add({.name = "held", .value = 0.25});
  result.table.add({.name = "untouched", .value = 0.0});
  result.table.add({.name = "a: b", .value = 1.0});
  result.calibrated = {0, 1};
  EXPECT_EQ(detail::values_yaml(robot, result, {}),
            "elbow: 0.1\nwrist: 0.0\nheld: 0.25\n\"a: b\": 1.0\n");
  const std::map<int, double> deviations = {{0, 0.00234},
                                            {1, std::numeric_limits<double>::infinity()}};
  EXPECT_EQ(detail::values_yaml(robot, result, deviations),
            "elbow: 0.1  # +- 0.0023\nwrist: 0.0  # not determined\nheld: 0.25\n\"a: b\": 1.0\n");
}

TEST(ResultFiles, WhatAUrdfCannotHoldHasItsFormula) {
  CalibrationResult result;
  result.table.add({.name = "elbow_gear_ratio", .value = 0.001});
  result.table.add({.name = "elbow_eccentric_sin", .value = 0.002});
  result.calibrated = {0, 1};
  EXPECT_EQ(detail::values_yaml(test::mobile_manipulator(), result, {{1, 0.0003}}),
            "elbow_gear_ratio: 0.001  # q_true = q + this * q\n"
            "elbow_eccentric_sin: 0.002  # +- 0.0003; q_true = q + this * sin(q)\n");
}

}  // namespace
}  // namespace kinecal
