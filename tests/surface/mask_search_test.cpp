#include "kinecal/surface/mask_search.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "support/mask_robot.hpp"

namespace kinecal {
namespace {

/// Masks of the arm as a search takes them.
std::vector<PosedMask> masks(const test::CloudPlan& plan) {
  const Robot robot = parse_urdf(test::mesh_robot_urdf(), "arm.urdf");
  std::vector<PosedMask> all;
  for (const Sample& sample : test::mask_robot_samples(robot, plan)) {
    PosedMask& mask = all.emplace_back();
    mask.links = test::mesh_robot_poses(robot, test::positions_of(sample));
    const CameraInfo info = test::mask_camera();
    const auto ideal = [&](double u, double v) {
      return Eigen::Vector2d((u - info.k[2]) / info.k[0], (v - info.k[5]) / info.k[4]);
    };
    mask.low = ideal(0.0, 0.0);
    mask.high = ideal(info.width - 1.0, info.height - 1.0);
    for (const Feature& edge : sample.observations.at(0).features) {
      mask.edges.push_back(
          {{(edge.point.x() - info.k[2]) / info.k[0], (edge.point.y() - info.k[5]) / info.k[4]},
           {edge.conditions.at("nu"), edge.conditions.at("nv")}});
    }
  }
  return all;
}

TEST(MaskSearch, FindsTheCameraFromNothing) {
  const RobotSurface surface = test::mesh_robot_surface();
  int found = 0;
  constexpr int kTrials = 8;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const std::vector<Pose<double>> poses =
        find_camera_poses(surface, masks({.samples = 4, .pixels = 2, .seed = seed}));
    const bool has_truth = std::any_of(poses.begin(), poses.end(), [](const Pose<double>& pose) {
      const Pose<double> truth = test::true_camera();
      return (pose.translation - truth.translation).norm() < 0.1 &&
             Eigen::AngleAxisd(pose.rotation.transpose() * truth.rotation).angle() < 0.1;
    });
    found += has_truth ? 1 : 0;
  }
  EXPECT_GE(found, kTrials - 1);
}

TEST(MaskSearch, HasNoAnswerWithoutMasksOrSurface) {
  EXPECT_TRUE(find_camera_poses(test::mesh_robot_surface(), {}).empty());
  std::vector<PosedMask> empty(2);
  for (PosedMask& mask : empty) mask.links.resize(4);
  EXPECT_TRUE(find_camera_poses(test::mesh_robot_surface(), empty).empty());
  EXPECT_TRUE(find_camera_poses(RobotSurface(), masks({.samples = 2, .pixels = 2})).empty());
}

}  // namespace
}  // namespace kinecal
