#include "kinecal/report/recorded_poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(RecordedPoses, AreThoseOfTheJointsOfTheChains) {
  test::NoisyScene scene(6);
  scene.solve();
  scene.samples[1].joint_names.pop_back();
  scene.samples[1].joint_positions.pop_back();
  const RecordedPoses poses = recorded_poses(scene.calibration, scene.samples);
  EXPECT_THAT(poses.joints, testing::Contains("elbow"));
  ASSERT_EQ(poses.positions.size(), 5u);  // one sample lacks a joint
  for (std::size_t j = 0; j < poses.joints.size(); ++j) {
    EXPECT_EQ(poses.positions[1][j], scene.samples[2].position(poses.joints[j]));
  }
}

TEST(RecordedPoses, AreAtMostAHundred) {
  test::NoisyScene scene(3);
  scene.solve();
  const Sample first = scene.samples[0];
  scene.samples.assign(250, first);
  EXPECT_EQ(recorded_poses(scene.calibration, scene.samples).positions.size(), 100u);
  EXPECT_EQ(recorded_poses(scene.calibration, {}).positions.size(), 0u);
}

}  // namespace
}  // namespace kinecal
