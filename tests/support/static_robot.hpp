// A robot as constant data with every kind of joint that a chain takes: skew and principal axes of
// either sign, sliding joints, mimics, origins that translate, rotate, or are the identity.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/kinematics/static_chain.hpp"

namespace kinecal::test {

/// A rotation with rational cosine (0.8) and sine (0.6), so that it is an exact constant.
constexpr PoseData turned_about(int axis, std::array<double, 3> shift = {}) {
  constexpr double kCos = 0.8, kSin = 0.6;
  if (axis == 0) return {{1, 0, 0, 0, kCos, -kSin, 0, kSin, kCos}, shift};
  if (axis == 1) return {{kCos, 0, kSin, 0, 1, 0, -kSin, 0, kCos}, shift};
  return {{kCos, -kSin, 0, kSin, kCos, 0, 0, 0, 1}, shift};
}
constexpr PoseData shifted(double x, double y, double z) {
  return {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {x, y, z}};
}

struct StaticRobot {
  static constexpr std::string_view kName = "static_robot";
  static constexpr std::array<JointData, 14> kJoints = {{
      {.name = "lift",
       .type = JointType::prismatic,
       .parent = "base",
       .child = "torso",
       .origin = shifted(-0.1, 0, 0.4),
       .axis = {0, 0, 1}},
      {.name = "pan",
       .type = JointType::revolute,
       .parent = "torso",
       .child = "shoulder",
       .origin = shifted(0.1, 0, 0.3),
       .axis = {0, 0, -1}},
      {.name = "mount",
       .type = JointType::fixed,
       .parent = "shoulder",
       .child = "plate",
       .origin = turned_about(0, {0.1, 0, 0}) * turned_about(2, {0, 0.05, 0})},
      {.name = "elbow",
       .type = JointType::continuous,
       .parent = "plate",
       .child = "forearm",
       .origin = turned_about(1, {0.2, -0.1, 0.05}),
       .axis = {1.0 / 3, 2.0 / 3, -2.0 / 3}},
      {.name = "wrist",
       .type = JointType::revolute,
       .parent = "forearm",
       .child = "hand",
       .origin = shifted(0, 0, 0),
       .axis = {1, 0, 0}},
      {.name = "tool",
       .type = JointType::fixed,
       .parent = "hand",
       .child = "tip",
       .origin = shifted(0.1, 0, 0)},
      {.name = "finger",
       .type = JointType::prismatic,
       .parent = "hand",
       .child = "finger_left",
       .origin = shifted(0.1, 0.02, 0),
       .axis = {0, 1, 0}},
      {.name = "finger_mimic",
       .type = JointType::prismatic,
       .parent = "hand",
       .child = "finger_right",
       .origin = turned_about(2, {0.1, -0.02, 0}),
       .axis = {0, 0.6, 0.8},
       .mimic = MimicData{"finger", -1.0, 0.003}},
      {.name = "weight",
       .type = JointType::revolute,
       .parent = "forearm",
       .child = "counterweight",
       .origin = shifted(0.2, 0, 0.1),
       .axis = {0, 0.6, 0.8},
       .mimic = MimicData{"wrist", -0.5, 0.1}},
      {.name = "head_pan",
       .type = JointType::revolute,
       .parent = "torso",
       .child = "neck",
       .origin = shifted(0.05, 0, 0.6),
       .axis = {0, 0, 1}},
      {.name = "head_tilt",
       .type = JointType::revolute,
       .parent = "neck",
       .child = "head",
       .origin = shifted(0.1, 0, 0.05),
       .axis = {0, 1, 0}},
      {.name = "camera_joint",
       .type = JointType::fixed,
       .parent = "head",
       .child = "camera_link",
       .origin = turned_about(1, {0.05, 0.02, 0})},
      {.name = "optical",
       .type = JointType::fixed,
       .parent = "camera_link",
       .child = "camera_frame",
       .origin = {{0, 0, 1, -1, 0, 0, 0, -1, 0}, {}}},
      {.name = "loose", .type = JointType::floating, .parent = "base", .child = "ball"},
  }};
};

static_assert(RobotData<StaticRobot>);

}  // namespace kinecal::test
