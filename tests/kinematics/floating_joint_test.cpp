#include "kinecal/kinematics/floating_joint.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "support/robots.hpp"

namespace kinecal {
namespace {

constexpr double kOfProducts = 1e-14;  // a dozen products of numbers of size one

double pose_distance(const Pose<double>& a, const Pose<double>& b) {
  return (a.rotation - b.rotation).norm() + (a.translation - b.translation).norm();
}

Pose<double> random_floating_pose(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Vector3<double> w(normal(random), normal(random), normal(random));
  return {exp(w), {normal(random), normal(random), normal(random)}};
}

/// Positions of the coordinates of "loose"; other joints stand at 0.4.
auto floating_at(const Pose<double>& measured) {
  return [at = floating_positions(measured)](const std::string& joint) {
    const auto part = floating_coordinate(joint);
    return part && part->joint == "loose" ? at[part->index] : 0.4;
  };
}

TEST(FloatingJoint, ItsCoordinatesGiveThePoseAgain) {
  std::mt19937 random(1);
  for (int i = 0; i < 100; ++i) {
    const Pose<double> pose = random_floating_pose(random);
    EXPECT_LE(pose_distance(floating_pose(floating_positions(pose)), pose), kOfProducts);
  }
}

TEST(FloatingJoint, ItsCoordinatesGiveThePoseAgainNearAndAtAPitchOfARightAngle) {
  constexpr double kRight = std::numbers::pi / 2;
  for (const double pitch : {kRight, -kRight, kRight - 1e-13, -kRight + 1e-9, kRight - 1e-6}) {
    const Pose<double> pose{rotation_from_rpy({0.3, pitch, -2.0}), {1.0, -2.0, 3.0}};
    EXPECT_LE(pose_distance(floating_pose(floating_positions(pose)), pose), 3e-12) << pitch;
  }
}

TEST(FloatingJoint, ACoordinateIsFoundByItsNameAndNoOtherJointIs) {
  const auto part = floating_coordinate(floating_coordinate("arm of robot", 3));
  ASSERT_TRUE(part);
  EXPECT_EQ(part->joint, "arm of robot");
  EXPECT_EQ(part->index, 3u);
  for (const char* name : {"yaw", "left_arm/yaw", "end of arm", "yaw_of_arm", ""}) {
    EXPECT_FALSE(floating_coordinate(std::string(name))) << name;
  }
}

TEST(FloatingJoint, AChainPassesItByItsMeasuredPoseBothWays) {
  const Robot robot = test::mobile_manipulator();
  std::mt19937 random(2);
  const RuntimeChain there = make_chain(robot, "hand", "ball");
  const RuntimeChain back = make_chain(robot, "ball", "hand");
  const RuntimeChain to_hand = make_chain(robot, "base_link", "hand");
  for (int i = 0; i < 20; ++i) {
    const Pose<double> measured = random_floating_pose(random);
    const auto at = floating_at(measured);
    const Pose<double> base_T_hand = forward_kinematics(to_hand, at);
    const Pose<double> expected = base_T_hand.inverse() * (robot.joint("loose").origin * measured);
    EXPECT_LE(pose_distance(forward_kinematics(there, at), expected), kOfProducts);
    EXPECT_LE(pose_distance(forward_kinematics(back, at), expected.inverse()), kOfProducts);
  }
}

TEST(FloatingJoint, ItsCorrectionStandsOnceAfterTheMeasuredPose) {
  const Robot robot = test::mobile_manipulator();
  std::mt19937 random(3);
  const Pose<double> measured = random_floating_pose(random);
  const Vector3<double> t(0.01, -0.02, 0.03), w(0.1, -0.2, 0.3);
  const Pose<double> base_T_ball = robot.joint("loose").origin * measured * Pose<double>{exp(w), t};
  for (const bool reversed : {false, true}) {
    const RuntimeChain chain = reversed ? make_chain(robot, "ball", "base_link", {"loose"})
                                        : make_chain(robot, "base_link", "ball", {"loose"});
    Corrections<double> corrections(chain.joints.size());
    int corrected = 0;
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      if (!chain.joints[i].corrected) continue;
      ++corrected;
      EXPECT_EQ(chain.joints[i].name, "loose");
      corrections[i].set_frame(t, w);
    }
    EXPECT_EQ(corrected, 1);
    const Pose<double> tip = forward_kinematics(chain, floating_at(measured), corrections);
    EXPECT_LE(pose_distance(tip, reversed ? base_T_ball.inverse() : base_T_ball), kOfProducts);
  }
}

TEST(FloatingJoint, ItsCoordinatesHaveNoPositionOfTheirOwn) {
  const RuntimeChain chain = make_chain(test::mobile_manipulator(), "ball", "forearm");
  const auto own = std::count_if(chain.joints.begin(), chain.joints.end(), has_position);
  const auto of_ball = std::count_if(chain.joints.begin(), chain.joints.end(),
                                     [](const ChainJoint& j) { return j.floating == "loose"; });
  EXPECT_EQ(of_ball, 6);
  EXPECT_EQ(own + of_ball, std::ssize(chain.joints));
  EXPECT_GT(own, 1);
}

}  // namespace
}  // namespace kinecal
