#include "kinecal/capture/session/pose_generation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <stdexcept>

#include "kinecal/capture/session/robot_body.hpp"
#include "support/robots.hpp"
#include "support/thrown.hpp"

namespace kinecal {
namespace {

CameraInfo camera_info() {
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.k = {554.25, 0, 320.5, 0, 554.25, 240.5, 0, 0, 1};
  info.p = {554.25, 0, 320.5, 0, 0, 554.25, 240.5, 0, 0, 0, 1, 0};
  return info;
}

ViewGoal board_in_hand() {
  ViewGoal goal;
  goal.base = "base_link";
  goal.camera = "camera_optical_frame";
  goal.info = camera_info();
  goal.target = "hand";
  goal.points = {{0.1, -0.05, -0.05}, {0.1, 0.05, -0.05}, {0.1, -0.05, 0.05}, {0.1, 0.05, 0.05}};
  goal.front = Vector3<double>(1, 0, 0);
  goal.radius = 0.02;  // the links of this robot are short
  return goal;
}

std::vector<double> positions_of(const RobotBody& body, const JointTarget& target) {
  std::vector<double> q(body.joints().size(), 0.0);
  for (std::size_t i = 0; i < q.size(); ++i) {
    for (std::size_t k = 0; k < target.names.size(); ++k) {
      if (target.names[k] == body.joints()[i]) q[i] = target.positions[k];
    }
  }
  return q;
}

TEST(PoseGeneration, EachPoseSeesTheWholeTargetFromItsFront) {
  const Robot robot = test::mobile_manipulator();
  const ViewGoal goal = board_in_hand();
  const std::vector<JointTarget> targets = poses_with_view_of(robot, goal, 20);
  ASSERT_EQ(targets.size(), 20U);
  const RobotBody body(robot, goal.base, goal.radius, {{"finger", 0.0}, {"torso_joint", 0.0}});
  for (const JointTarget& target : targets) {
    const std::vector<Pose<double>> poses = body.poses(positions_of(body, target));
    const Pose<double> camera_T_hand =
        poses[body.link(goal.camera)].inverse() * poses[body.link(goal.target)];
    for (const Vector3<double>& point : goal.points) {
      const Vector3<double> p = camera_T_hand * point;
      EXPECT_GE(p.z(), goal.nearest);
      EXPECT_LE(p.z(), goal.farthest);
      EXPECT_LT(std::abs(p.x() / p.z() * 554.25), 0.5 * 640 * 0.92);
      EXPECT_LT(std::abs(p.y() / p.z() * 554.25), 0.5 * 480 * 0.92);
    }
    const Vector3<double> centre = camera_T_hand * Vector3<double>(0.1, 0, 0);
    EXPECT_LT(camera_T_hand.rotation.col(0).dot(centre.normalized()),
              -std::cos(goal.most_angle) + 1e-9);
    EXPECT_FALSE(body.touches_itself(poses));
    for (const Joint& joint : robot.joints()) {
      for (std::size_t k = 0; joint.limits && k < target.names.size(); ++k) {
        if (target.names[k] != joint.name) continue;
        EXPECT_GE(target.positions[k], joint.limits->lower);
        EXPECT_LE(target.positions[k], joint.limits->upper);
      }
    }
  }
}

TEST(PoseGeneration, PosesSpreadAndAreTheSameForTheSameSeed) {
  const Robot robot = test::mobile_manipulator();
  const ViewGoal goal = board_in_hand();
  const std::vector<JointTarget> a = poses_with_view_of(robot, goal, 10, 7);
  const std::vector<JointTarget> b = poses_with_view_of(robot, goal, 10, 7);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].positions, b[i].positions);
  // Farther apart than poses by chance: each from its nearest.
  const auto nearest = [](const std::vector<JointTarget>& all) {
    double least = 1e9;
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) {
        double sum = 0.0;
        for (std::size_t j = 0; j < all[i].positions.size(); ++j) {
          sum += std::pow(all[i].positions[j] - all[k].positions[j], 2);
        }
        least = std::min(least, std::sqrt(sum));
      }
    }
    return least;
  };
  EXPECT_GT(nearest(a), 0.5);
}

TEST(PoseGeneration, KeepsOtherJointsAtRest) {
  ViewGoal goal = board_in_hand();
  goal.joints = {"shoulder_pan", "shoulder_lift", "elbow", "wrist", "head_tilt"};
  goal.rest["head_pan"] = 0.1;
  for (const JointTarget& target : poses_with_view_of(test::mobile_manipulator(), goal, 3)) {
    EXPECT_EQ(std::set<std::string>(target.names.begin(), target.names.end()),
              std::set<std::string>(goal.joints.begin(), goal.joints.end()));
  }
}

TEST(PoseGeneration, SaysWhatIsWrongIfThereIsNone) {
  ViewGoal goal = board_in_hand();
  goal.farthest = 0.26;
  goal.nearest = 5.0;
  EXPECT_THAT(test::thrown<std::runtime_error>([&] {
                static_cast<void>(poses_with_view_of(test::mobile_manipulator(), goal, 1));
              }),
              testing::HasSubstr("too near"));
  goal = board_in_hand();
  goal.points.clear();
  EXPECT_THROW(static_cast<void>(poses_with_view_of(test::mobile_manipulator(), goal, 1)),
               std::invalid_argument);
  goal = board_in_hand();
  goal.camera = "camra";
  EXPECT_THROW(static_cast<void>(poses_with_view_of(test::mobile_manipulator(), goal, 1)),
               RobotError);
  goal = board_in_hand();
  goal.target = "head_tilt_link";
  EXPECT_THROW(static_cast<void>(poses_with_view_of(test::mobile_manipulator(), goal, 1)),
               std::invalid_argument);
}

/// A torso with a camera, an arm and a leg: the torso is the root, or stands on one.
Robot legged(bool on_footprint) {
  using enum JointType;
  const JointLimits wide{-2.0, 2.0};
  const auto turn = [&](const char* name, const char* parent, const char* child,
                        const Vector3<double>& at, const Vector3<double>& axis) {
    return Joint{name, revolute, parent, child, test::origin(at), axis, {}, wide};
  };
  Joint camera{"camera_joint", fixed, "torso", "camera", test::origin({0.1, 0.0, 0.4})};
  camera.origin.rotation << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // looks along x
  std::vector<Joint> joints = {camera,
                               turn("shoulder", "torso", "upper_arm", {0, 0.2, 0.3}, {0, 1, 0}),
                               turn("elbow", "upper_arm", "forearm", {0.3, 0, 0}, {0, 1, 0}),
                               turn("roll", "forearm", "wrist", {0.25, 0, 0}, {1, 0, 0}),
                               turn("wrist", "wrist", "hand", {0.05, 0, 0}, {0, 0, 1}),
                               turn("hip", "torso", "thigh", {0, 0, -0.1}, {0, 1, 0}),
                               turn("knee", "thigh", "shin", {0, 0, -0.4}, {0, 1, 0}),
                               {"sole_joint", fixed, "shin", "sole", test::origin({0, 0, -0.4})}};
  if (on_footprint) joints.push_back({"up", fixed, "foot", "torso", test::origin({0, 0, 0.9})});
  return Robot("legged", std::move(joints));
}

TEST(PoseGeneration, TheFloorIsBelowTheFeetOfARobotWhoseRootIsItsTorso) {
  ViewGoal goal = board_in_hand();
  goal.front.reset();
  goal.points = {{0.05, 0.0, 0.0}};
  goal.camera = "camera";
  for (const bool on_footprint : {false, true}) {
    const Robot robot = legged(on_footprint);
    goal.base = on_footprint ? "foot" : "torso";
    EXPECT_NEAR(floor_height(robot, goal), on_footprint ? 0.0 : -0.9, 1e-12);
    goal.ground = floor_height(robot, goal) - 0.01;
    EXPECT_EQ(poses_with_view_of(robot, goal, 6).size(), 6U);
  }
}

}  // namespace
}  // namespace kinecal
