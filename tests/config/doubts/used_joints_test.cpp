// Which joints a calibration uses, and where they were.
#include "kinecal/config/doubts/used_joints.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/arm_scene.hpp"

namespace kinecal {
namespace {

using testing::ElementsAre;

class UsedJoints : public test::ArmScene {};

TEST_F(UsedJoints, AreThoseThatMoveAModelInTheRobotsOrder) {
  for (Sample& sample : samples) std::reverse(sample.joint_names.begin(), sample.joint_names.end());
  const auto joints = detail::used_joints(config(), parse_urdf(urdf, "arm.urdf"), samples);
  std::vector<std::string> names;
  for (const auto& joint : joints) names.push_back(joint.joint.name);
  EXPECT_THAT(names, ElementsAre("pan", "lift", "elbow", "roll", "flex"));
  EXPECT_EQ(joints[0].positions[3], samples[3].joint_positions[4]);
  EXPECT_EQ(joints[0].samples.size(), samples.size());
}

TEST_F(UsedJoints, LackPositionsOfSamplesWithoutThem) {
  samples[2].joint_names[1] = "other";
  const auto joints = detail::used_joints(config(), parse_urdf(urdf, "arm.urdf"), samples);
  EXPECT_EQ(joints[1].positions.size(), samples.size() - 1);
  EXPECT_EQ(joints[1].samples[2], 3u);
}

TEST_F(UsedJoints, StandForThoseThatMimicThem) {
  replace(urdf, "<axis xyz=\"0 1 0\"/>\n    <limit lower=\"0.6\"",
          "<axis xyz=\"0 1 0\"/><mimic joint=\"lift\"/>\n    <limit lower=\"0.6\"");
  const auto joints = detail::used_joints(config(), parse_urdf(urdf, "arm.urdf"), samples);
  EXPECT_EQ(joints.size(), 4u);
}

TEST_F(UsedJoints, ModelsInPixelsAreKnownByTheirType) {
  EXPECT_THAT(detail::pixel_models(config()), testing::IsEmpty());
  replace(config_text, "{name: tracker, type: chain3d", "{name: tracker, type: camera2d");
  replace(config_text, "chain3d_to_chain3d, model_a: arm, model_b",
          "chain3d_to_camera2d, model_3d: arm, model_2d");
  EXPECT_THAT(detail::pixel_models(config()), ElementsAre("tracker"));
}

TEST_F(UsedJoints, LimitsHaveTheirUnit) {
  const auto joints = detail::used_joints(config(), parse_urdf(urdf, "arm.urdf"), samples);
  EXPECT_EQ(joints[0].limits_text(), "±2.9 rad");
  EXPECT_EQ(joints[1].limits_text(), "[-1.2, 1.4] rad");
}

}  // namespace
}  // namespace kinecal
