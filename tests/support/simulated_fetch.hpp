// A simulated Fetch: four LEDs on its gripper, which its head sees, and errors of the paper's size.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/recordings/pose_messages.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/urdf/velocity_limits.hpp"
#include "kinecal/study/seeded_random.hpp"
#include "kinecal/study/simulated_robot.hpp"
#include "kinecal/study/true_robot.hpp"
#include "support/paths.hpp"

namespace kinecal::test {

inline constexpr const char* kFetchLedLink = "gripper_led_frame";
inline constexpr const char* kFetchCamera = "head_camera_rgb_optical_frame";

/// Where the LEDs are in kFetchLedLink, metres.
inline std::vector<Vector3<double>> fetch_leds() {
  return {{0.0265, 0.0355, 0.0},
          {-0.0265, 0.0355, 0.0},
          {-0.0265, -0.0355, 0.0},
          {0.0265, -0.0355, 0.0}};
}

/// Adds an error of a random sign.
inline void add_error(ParameterTable& truth, SeededRandom& random, const std::string& name,
                      double least, double most) {
  truth.add({.name = name, .value = random.either_sign(least, most)});
}

/// Joints are 2 to 4 degrees off, the frame of the head 1 to 2 cm, the camera's 5 to 10 mm and 1 to 2
/// degrees, its lens 1 to 2 percent, its depth 5 mm and 1 percent.
inline ParameterTable fetch_errors(SeededRandom& random) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  ParameterTable truth;
  for (const char* joint :
       {"shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
        "forearm_roll_joint", "wrist_flex_joint", "wrist_roll_joint", "head_tilt_joint"}) {
    add_error(truth, random, joint, 2.0 * kDegree, 4.0 * kDegree);
  }
  for (const char* axis : {"_x", "_y", "_z"}) {
    add_error(truth, random, std::string("head_pan_joint") + axis, 0.01, 0.02);
    add_error(truth, random, std::string("head_camera_rgb_joint") + axis, 0.005, 0.01);
  }
  for (const char* axis : {"_a", "_b", "_c"}) {
    add_error(truth, random, std::string("head_camera_rgb_joint") + axis, kDegree, 2.0 * kDegree);
  }
  for (const char* name : {"camera_fx", "camera_fy", "camera_cx", "camera_cy"}) {
    add_error(truth, random, name, 0.005, 0.01);
  }
  add_error(truth, random, "camera_z_offset", 0.003, 0.007);
  add_error(truth, random, "camera_z_scaling", 0.005, 0.01);
  return truth;
}

/// The robot, with these errors.
inline SimulatedSetup simulated_fetch(std::uint64_t seed) {
  SeededRandom random(seed);
  SimulatedSetup setup;
  const std::string urdf = source_folder() + "/examples/robots/fetch/fetch.urdf";
  setup.robot = read_urdf(urdf);
  setup.speeds = velocity_limits(read_urdf_text(urdf), urdf);
  setup.base = "base_link";
  setup.seed = seed;
  setup.truth = fetch_errors(random);
  setup.frames = {"head_pan_joint", "head_camera_rgb_joint"};
  setup.camera.frame = kFetchCamera;
  add_ground(setup.scene);
  add_box(setup.scene, kFetchLedLink, {Matrix3<double>::Identity(), {0.02, 0.0, -0.0405}},
          {0.16, 0.12, 0.08});
  add_leds(setup.scene, kFetchLedLink, fetch_leds(), {0.0, 0.0, 1.0});
  return setup;
}

/// RMS distance of the LEDs in the camera between two robots, over poses at which they were measured,
/// metres.
inline double led_difference(const TrueRobot& a, const TrueRobot& b,
                             const std::vector<Sample>& samples) {
  double squares = 0.0;
  int points = 0;
  for (const Sample& sample : samples) {
    Positions positions;
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      positions[sample.joint_names[i]] = sample.joint_positions[i];
    }
    const auto in_camera = [&](const TrueRobot& robot) {
      return robot.pose("base_link", kFetchCamera, positions).inverse() *
             robot.pose("base_link", kFetchLedLink, positions);
    };
    const Pose<double> of_a = in_camera(a), of_b = in_camera(b);
    for (const Vector3<double>& led : fetch_leds()) {
      squares += (of_a * led - of_b * led).squaredNorm();
      ++points;
    }
  }
  return std::sqrt(squares / std::max(1, points));
}

/// Poses of a bag, of the joints that a robot has.
inline std::vector<CapturePose> poses_for(const Robot& robot, const std::string& bag) {
  Diagnostics diagnostics;
  std::vector<CapturePose> poses = read_bag_poses(bag, diagnostics);
  diagnostics.throw_if_errors();
  for (CapturePose& pose : poses) {
    CapturePose kept{{}, {}, pose.features};
    for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
      if (!robot.has_joint(pose.joint_names[i])) continue;
      const auto& limits = robot.joint(pose.joint_names[i]).limits;
      const double position = pose.positions[i];
      kept.joint_names.push_back(pose.joint_names[i]);
      kept.positions.push_back(limits ? std::clamp(position, limits->lower, limits->upper)
                                      : position);
    }
    pose = kept;
  }
  return poses;
}

}  // namespace kinecal::test
