#include "kinecal/trust/uncertainty/workspace_map.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// The scene's robot, whose joints can only be where a sample has them.
Robot held_robot(const Sample& at) {
  const Robot free = test::mobile_manipulator();
  std::vector<Joint> joints = free.joints();
  for (Joint& joint : joints) {
    if (const auto position = at.position(joint.name)) joint.limits = {*position, *position};
  }
  return {free.name(), std::move(joints)};
}

TEST(WorkspaceMap, IsTheUncertaintyOfThePoseAtOneSample) {
  test::NoisyScene scene(20);
  const Assessment found = scene.solve_and_assess();
  const Eigen::VectorXd values = scene.values();
  const auto problem = make_problem(held_robot(scene.samples[3]), "base_link",
                                    test::table_with_units(), test::kSceneFrames);
  const auto map =
      workspace_map(*problem, found, found.compared[0], test::NoisyScene::span(values), 3);
  const auto evaluator = scene.solved().evaluator(scene.free());
  const LinearFit fit = scene.linear(*evaluator);
  const PoseUncertainty there = pose_uncertainty(
      scene.solved(), scene.free(), test::NoisyScene::span(values), fit, found.uncertainty,
      std::span(&scene.samples[3], 1), {found.compared[0].link, found.compared[0].frame},
      {found.compared[0].in_link});
  ASSERT_EQ(map.size(), 3u);
  for (const KnownPoint& point : map) {
    EXPECT_NEAR(point.deviation, there.position, 1e-9 * there.position);
  }
}

TEST(WorkspaceMap, ReachesBeyondTheSamples) {
  test::NoisyScene scene(20);
  const Assessment found = scene.solve_and_assess();
  const Eigen::VectorXd values = scene.values();
  const auto map =
      workspace_map(scene.solved(), found, found.compared[0], test::NoisyScene::span(values), 300);
  ASSERT_EQ(map.size(), 300u);
  double least = 1.0, most = 0.0;
  for (const KnownPoint& point : map) {
    least = std::min(least, point.deviation);
    most = std::max(most, point.deviation);
  }
  EXPECT_GT(least, 0.0);
  EXPECT_LT(least, found.compared[0].position);
  EXPECT_GT(most, found.compared[0].worst_position);
  EXPECT_LT(most, 0.1);
}

TEST(WorkspaceMap, FollowsTheCameraIfTheOtherFrameStands) {
  test::NoisyScene scene(20);
  Assessment found = scene.solve_and_assess();
  found.compared[0].frame = found.compared[0].link = "base_link";  // in the camera's frame
  const Eigen::VectorXd values = scene.values();
  const auto map =
      workspace_map(scene.solved(), found, found.compared[0], test::NoisyScene::span(values), 50);
  ASSERT_EQ(map.size(), 50u);
  double farthest = 0.0;
  for (const KnownPoint& point : map) {
    for (int k = 0; k < 3; ++k) {
      farthest = std::max(farthest, std::abs(point.p_base[static_cast<std::size_t>(k)] -
                                             map.front().p_base[static_cast<std::size_t>(k)]));
    }
  }
  EXPECT_GT(farthest, 0.01) << "the head turns the camera";
}

TEST(WorkspaceMap, IsEmptyWhereNothingIsFree) {
  test::NoisyScene scene(20);
  Assessment found = scene.solve_and_assess();
  found.parameters.clear();
  const Eigen::VectorXd values = scene.values();
  EXPECT_TRUE(
      workspace_map(scene.solved(), found, found.compared[0], test::NoisyScene::span(values), 10)
          .empty());
}

}  // namespace
}  // namespace kinecal
