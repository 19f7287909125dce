#include "kinecal/samples/sample.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(Sample, FindsPositionsByTheNamesOfTheirJoints) {
  Sample sample;
  sample.joint_names = {"elbow", "wrist", "lift"};
  sample.joint_positions = {0.1, 0.2, 0.3};
  EXPECT_EQ(sample.position("elbow"), 0.1);
  EXPECT_EQ(sample.position("lift"), 0.3);
  EXPECT_EQ(sample.position("elbo"), std::nullopt);
  EXPECT_EQ(Sample().position("elbow"), std::nullopt);
}

TEST(Sample, HasThePositionsOfTheCoordinatesOfAMeasuredPose) {
  Sample sample;
  sample.joint_names = {"elbow"};
  sample.joint_positions = {0.1};
  sample.poses["flange"] = {rotation_from_rpy({0.3, -0.2, 2.0}), {1.0, 2.0, 3.0}};
  EXPECT_EQ(sample.position("elbow"), 0.1);
  EXPECT_EQ(sample.position(floating_coordinate("flange", 1)), 2.0);
  EXPECT_NEAR(sample.position(floating_coordinate("flange", 3)).value(), 2.0, 1e-15);
  EXPECT_NEAR(sample.position(floating_coordinate("flange", 5)).value(), 0.3, 1e-15);
  EXPECT_EQ(sample.position("flange"), std::nullopt);
  EXPECT_EQ(sample.position(floating_coordinate("flagne", 1)), std::nullopt);
}

TEST(Sample, AddsToPositionsOfJointsAndOfCoordinates) {
  Sample sample;
  sample.joint_names = {"elbow"};
  sample.joint_positions = {0.1};
  sample.poses["flange"] = {rotation_from_rpy({0.3, -0.2, 2.0}), {1.0, 2.0, 3.0}};
  sample.add_to_position("elbow", 0.25);
  sample.add_to_position(floating_coordinate("flange", 2), 0.5);
  sample.add_to_position(floating_coordinate("flange", 4), 0.1);
  sample.add_to_position("wrist", 7.0);
  EXPECT_EQ(sample.position("elbow"), 0.35);
  const Matrix3<double> turned = rotation_from_rpy({0.3, -0.1, 2.0});
  EXPECT_NEAR((sample.poses["flange"].rotation - turned).norm(), 0.0, 1e-15);
  EXPECT_EQ(sample.poses["flange"].translation, Vector3<double>(1.0, 2.0, 3.5));
}

TEST(Sample, FindsWhatASensorObserved) {
  Sample sample;
  sample.observations = {{"arm", {}, {}}, {"camera", {{"frame", {1, 2, 3}}}, {}}};
  ASSERT_NE(sample.observation("camera"), nullptr);
  EXPECT_EQ(sample.observation("camera"), &sample.observations[1]);
  EXPECT_EQ(sample.observation("arm"), &sample.observations[0]);
  EXPECT_EQ(sample.observation("eye"), nullptr);
}

}  // namespace
}  // namespace kinecal
