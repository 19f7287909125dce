#include "kinecal/trust/verify/pose_change.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(PoseChange, IsThatOfTheOraclesPoses) {
  const test::NoisyScene scene(10);
  const auto problem = scene.problem({});
  const std::vector<double> before = test::random_values(problem->table(), 0.02, 5),
                            after = test::random_values(problem->table(), 0.03, 6);
  const auto oracle = test::scene_problem();
  double squares = 0.0, worst = 0.0, turned = 0.0;
  for (const Sample& sample : scene.samples) {
    const auto hand_in_camera = [&](const std::vector<double>& values) {
      return test::tip_pose(oracle, 1, "camera_optical_frame", sample, values).inverse() *
             test::tip_pose(oracle, 0, "hand", sample, values);
    };
    const Pose<double> was = hand_in_camera(before), is = hand_in_camera(after);
    const double distance = (was.translation - is.translation).norm();
    squares += distance * distance;
    worst = std::max(worst, distance);
    const Matrix3<double> turn = was.rotation.transpose() * is.rotation;
    turned = std::max(turned, std::acos(0.5 * (turn.trace() - 1.0)));
  }
  const PoseChange change = pose_change({*problem, before}, {*problem, after}, scene.samples,
                                        {"hand"}, {"camera_optical_frame"});
  EXPECT_EQ(change.poses, 10);
  EXPECT_NEAR(change.position, std::sqrt(squares / 10.0), 1e-12);
  EXPECT_NEAR(change.worst_position, worst, 1e-12);
  EXPECT_NEAR(change.worst_rotation, turned, 1e-8);
  EXPECT_LE(change.rotation, change.worst_rotation);
}

TEST(PoseChange, IsZeroForTheSameValuesAndLeavesOutPosesWithoutTheJoints) {
  test::NoisyScene scene(4);
  const auto problem = scene.problem({});
  const std::vector<double> values = test::random_values(problem->table(), 0.02, 5);
  scene.samples[2].joint_names.clear();
  scene.samples[2].joint_positions.clear();
  const PoseChange change = pose_change({*problem, values}, {*problem, values}, scene.samples,
                                        {"hand"}, {"camera_optical_frame"});
  EXPECT_EQ(change.poses, 3);
  EXPECT_NEAR(change.worst_position, 0.0, 1e-12);
  EXPECT_NEAR(change.worst_rotation, 0.0, 1e-7);
}

}  // namespace
}  // namespace kinecal
