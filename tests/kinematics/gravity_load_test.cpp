// Loads of gravity against the change of potential energy; through mimic and sliding joints.
#include "kinecal/kinematics/gravity_load.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

Robot lift_with_fingers() {
  using enum JointType;
  std::vector<Joint> joints(4);
  joints[0] = {.name = "lift", .type = prismatic, .parent = "base", .child = "carriage"};
  joints[0].axis = {0.0, 0.0, 1.0};
  joints[1] = {.name = "arm", .type = revolute, .parent = "carriage", .child = "arm_link"};
  joints[1].origin.translation = {0.1, 0.2, 0.3};
  joints[1].axis = {0.0, 1.0, 0.0};
  joints[2] = {.name = "wrist", .type = continuous, .parent = "arm_link", .child = "wrist_link"};
  joints[2].origin.translation = {0.5, 0.0, 0.0};
  joints[2].axis = {1.0, 2.0, -1.0};
  joints[3] = {.name = "finger", .type = revolute, .parent = "wrist_link", .child = "finger_link"};
  joints[3].origin.translation = {0.1, 0.0, 0.1};
  joints[3].axis = {0.0, 1.0, 0.0};
  joints[3].mimic = {"wrist", -0.5, 0.2};
  Robot robot("lift", joints);
  robot.set_weight({{{"carriage", {3.0, {0.0, 0.1, 0.0}}},
                     {"arm_link", {2.0, {0.2, 0.0, 0.05}}},
                     {"wrist_link", {1.0, {0.0, 0.1, 0.1}}},
                     {"finger_link", {0.5, {0.1, 0.0, 0.0}}}},
                    {0.3, -0.1, -9.7},
                    {}});
  return robot;
}

/// The pose of a link in the root, joint by joint.
Pose<double> pose_of(const Robot& robot, const std::string& link,
                     const std::map<std::string, double>& q) {
  const Joint* joint = robot.parent_joint(link);
  if (joint == nullptr) return {};
  const Mimic by = drive(robot, *joint);
  return pose_of(robot, joint->parent, q) * joint->origin *
         joint_pose(joint->type, joint->axis,
                    make_joint_state(by.multiplier * q.at(by.joint) + by.offset));
}

double work(const Robot& robot, const std::map<std::string, double>& q) {
  double sum = 0.0;
  for (const auto& [link, of] : robot.weight().links) {
    sum += of.mass * robot.weight().gravity.dot(pose_of(robot, link, q) * of.center);
  }
  return sum;
}

TEST(GravityLoads, AreTheWorkOfGravityPerUnitOfAJoint) {
  const Robot robot = lift_with_fingers();
  const std::map<std::string, double> q = {{"lift", 0.2}, {"arm", 0.4}, {"wrist", -0.9}};
  GravityLoads loads(robot, [&](const std::string& joint) { return q.at(joint); });
  const GravityLoads::ByJoint of_links = loads.of_links();
  for (const auto& [joint, position] : q) {
    constexpr double kStep = 1e-5;
    auto more = q, less = q;
    more[joint] += kStep;
    less[joint] -= kStep;
    EXPECT_NEAR(of_links.at(joint), (work(robot, more) - work(robot, less)) / (2.0 * kStep), 1e-7)
        << joint;
  }
  EXPECT_NEAR(of_links.at("lift"), -9.7 * 6.5, 1e-9);
  EXPECT_FALSE(of_links.contains("finger"));  // its load is on the joint that drives it
}

TEST(GravityLoads, OfLinksThatDoNotExistAreRefused) {
  Robot robot = lift_with_fingers();
  EXPECT_THROW(robot.set_weight({{{"hand", {1.0, {}}}}, {}, {}}), RobotError);
  EXPECT_THROW(robot.set_weight({{}, {0.0, 0.0, -9.81}, "hand"}), RobotError);
  EXPECT_THROW(robot.set_weight({{{"arm_link", {-1.0, Vector3<double>::Zero()}}}, {}, {}}),
               RobotError);
}

}  // namespace
}  // namespace kinecal
