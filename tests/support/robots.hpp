// Robots in code, for tests without files.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::test {

inline Pose<double> origin(const Vector3<double>& xyz, const Vector3<double>& rpy = {0, 0, 0}) {
  return {rotation_from_rpy(rpy), xyz};
}

/// A sliding torso, an arm with skew axes and a gripper whose second finger mimics the first, and a
/// pan-tilt head with a camera: every kind of joint that a chain takes.
inline Robot mobile_manipulator() {
  using enum JointType;
  return Robot(
      "mobile_manipulator",
      {
          {"torso_joint", prismatic, "base_link", "torso", origin({-0.1, 0, 0.4}), {0, 0, 1}},
          {"shoulder_pan", revolute, "torso", "shoulder", origin({0.12, 0, 0.35}), {0, 0, 1}},
          {"shoulder_lift", revolute, "shoulder", "upper_arm", origin({0.1, 0, 0.06}), {0, 1, 0}},
          {"elbow_mount", fixed, "upper_arm", "elbow_plate", origin({0.2, 0, 0}, {0.1, 0.2, 0.3})},
          {"elbow",
           continuous,
           "elbow_plate",
           "forearm",
           origin({0.1, 0.02, 0}, {0.5, 0, 0.1}),
           {1, 2, -1}},
          {"wrist", revolute, "forearm", "hand", origin({0.3, 0, 0}, {0, -0.4, 0}), {0.3, 0.1, 1}},
          {"finger", prismatic, "hand", "finger_left", origin({0.1, 0.02, 0}), {0, 1, 0}},
          {"finger_mimic",
           prismatic,
           "hand",
           "finger_right",
           origin({0.1, -0.02, 0}),
           {0, 1, 0.2},
           Mimic{"finger", -1.0, 0.003}},
          {"wrist_mimic",
           revolute,
           "forearm",
           "counterweight",
           origin({0.2, 0, 0.1}),
           {0, 1, 1},
           Mimic{"wrist", -0.5, 0.1}},
          {"head_pan", revolute, "torso", "head_pan_link", origin({0.05, 0, 0.6}), {0, 0, 1}},
          {"head_tilt",
           revolute,
           "head_pan_link",
           "head_tilt_link",
           origin({0.14, 0, 0.06}),
           {0, 1, 0}},
          {"camera_joint", fixed, "head_tilt_link", "camera_link", origin({0.05, 0.02, 0.02})},
          {"camera_optical", fixed, "camera_link", "camera_optical_frame",
           origin({0, 0, 0}, {-std::numbers::pi / 2, 0, -std::numbers::pi / 2})},
          {"loose", floating, "base_link", "ball", origin({1, 0, 0})},
      });
}

/// Positions for any joint by name, fixed by a seed.
class RandomPositions {
 public:
  explicit RandomPositions(unsigned seed) : random_(seed) {}
  double operator()(const std::string& joint) {
    const auto it = positions_.find(joint);
    if (it != positions_.end()) return it->second;
    return positions_[joint] = std::uniform_real_distribution<double>(-1.5, 1.5)(random_);
  }

 private:
  std::mt19937 random_;
  std::map<std::string, double> positions_;
};

}  // namespace kinecal::test
