#include "kinecal/surface/pose_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "support/mesh_robot.hpp"

namespace kinecal {
namespace {

/// Clouds of the arm in the frame of the camera.
std::vector<PosedCloud> clouds(const test::CloudPlan& plan) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  std::vector<PosedCloud> all;
  for (const Sample& sample : test::mesh_robot_samples(robot, plan)) {
    PosedCloud& cloud = all.emplace_back();
    std::map<std::string, double> q;
    for (std::size_t j = 0; j < sample.joint_names.size(); ++j) {
      q[sample.joint_names[j]] = sample.joint_positions[j];
    }
    cloud.links = test::mesh_robot_poses(robot, q);
    for (const Feature& feature : sample.observations[0].features) {
      cloud.points.push_back(feature.point);
    }
  }
  return all;
}

/// True if some pose is near the truth: rounds find it from there.
bool has_truth(const std::vector<Pose<double>>& poses) {
  return std::any_of(poses.begin(), poses.end(), [](const Pose<double>& pose) {
    const Pose<double> truth = test::true_camera();
    constexpr double kNear = 0.12, kTurned = 0.25;
    return (pose.translation - truth.translation).norm() < kNear &&
           Eigen::AngleAxisd(pose.rotation.transpose() * truth.rotation).angle() < kTurned;
  });
}

TEST(PoseSearch, FindsTheCameraFromNothing) {
  const RobotSurface surface = test::mesh_robot_surface();
  int found = 0;
  constexpr int kTrials = 10;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    found += has_truth(find_poses(surface, clouds({.samples = 3, .noise = 0.003, .seed = seed})))
                 ? 1
                 : 0;
  }
  EXPECT_GE(found, kTrials - 1);
}

TEST(PoseSearch, FindsItBeforeAWall) {
  const RobotSurface surface = test::mesh_robot_surface();
  int found = 0;
  constexpr int kTrials = 5;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const test::CloudPlan plan{.samples = 4, .noise = 0.003, .background = true, .seed = seed};
    found += has_truth(find_poses(surface, clouds(plan))) ? 1 : 0;
  }
  EXPECT_GE(found, kTrials - 1) << "what moves is the robot";
}

TEST(PoseSearch, HasNoAnswerWithoutPointsOrSurface) {
  EXPECT_TRUE(find_poses(test::mesh_robot_surface(), {}).empty());
  std::vector<PosedCloud> empty(2);
  for (PosedCloud& cloud : empty) cloud.links.resize(4);
  EXPECT_TRUE(find_poses(test::mesh_robot_surface(), empty).empty());
  EXPECT_TRUE(find_poses(RobotSurface(), clouds({.samples = 2})).empty());
}

}  // namespace
}  // namespace kinecal
