// A simulated robot for the examples: random numbers, poses and a depth camera.  true_robot.hpp has
// the robot's true kinematics.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal::examples {

inline constexpr double kDegree = std::numbers::pi / 180.0;

using kinecal::SeededRandom;

/// A sample without observations: each joint at a random position within its limits.
[[nodiscard]] inline Sample random_pose(const Robot& robot, SeededRandom& random) {
  Sample sample;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    sample.joint_names.push_back(joint.name);
    sample.joint_positions.push_back(joint.limits
                                         ? random.uniform(joint.limits->lower, joint.limits->upper)
                                         : random.uniform(-std::numbers::pi, std::numbers::pi));
  }
  return sample;
}

/// A camera of 640 x 480 pixels, as its driver reports it.
[[nodiscard]] inline CameraInfo example_camera_info() {
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  info.k = {554.25, 0, 320.5, 0, 554.25, 240.5, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {554.25, 0, 320.5, 0, 0, 554.25, 240.5, 0, 0, 0, 1, 0};
  return info;
}

/// Focal lengths and principal point of a rectified image, pixels.
struct Intrinsics {
  double fx, fy, cx, cy;
};
[[nodiscard]] inline Intrinsics intrinsics_of(const CameraInfo& info) {
  return {info.p[0], info.p[5], info.p[2], info.p[6]};
}

/// Noise of a depth camera.
struct CameraNoise {
  double pixel = 0.6;    ///< standard deviation, pixels
  double depth = 0.001;  ///< standard deviation at 1 m, metres; it grows with the square
};

/// The point that the driver reports, with noise: the true camera has parameters v, but the driver
/// uses those of `camera`.  The inverse of DepthCamera::place.
/// @param p_camera  (3) the point, metres, in the camera's true optical frame
/// @param v         (6) fx fy cx cy z_offset z_scaling, as DepthCamera has them
/// @returns         (3) metres
[[nodiscard]] inline Vector3<double> recorded_point(const Intrinsics& camera,
                                                    const Vector3<double>& p_camera,
                                                    const std::array<double, 6>& v,
                                                    const CameraNoise& noise,
                                                    SeededRandom& random) {
  const double z = p_camera.z();
  const double raw = z / (1.0 + v[5]) - v[4] + noise.depth * z * z * random.normal();
  const double x = camera.fx * (1.0 + v[0]) * p_camera.x() / z + camera.cx * v[2];
  const double y = camera.fy * (1.0 + v[1]) * p_camera.y() / z + camera.cy * v[3];
  const double right = x + noise.pixel * random.normal();
  const double down = y + noise.pixel * random.normal();
  return {right * raw / camera.fx, down * raw / camera.fy, raw};
}

/// True if the point is in the camera's image, and not at its edge.
/// @param p_camera  (3) metres, in the optical frame
[[nodiscard]] inline bool is_in_image(const Intrinsics& camera, const Vector3<double>& p_camera) {
  constexpr double kUsed = 0.9;  // of the image
  return p_camera.z() > 0.0 &&
         std::abs(camera.fx * p_camera.x()) < kUsed * camera.cx * p_camera.z() &&
         std::abs(camera.fy * p_camera.y()) < kUsed * camera.cy * p_camera.z();
}

/// Points of a link: as a depth camera reports them, and their known positions.
struct Look {
  Observation seen, known;
};

/// The points that are in the camera's image and at most 2 m away.
/// @param camera  the sensor's name
/// @param frame   its optical frame
/// @param points  metres, in the link
[[nodiscard]] inline Look look_at(const std::vector<Vector3<double>>& points,
                                  const std::string& link, const std::string& camera,
                                  const std::string& frame, const Pose<double>& frame_T_link,
                                  SeededRandom& random) {
  const CameraInfo info = example_camera_info();
  const Intrinsics driver = intrinsics_of(info);
  Look look{{camera, {}, info}, {"", {}, {}}};
  for (const Vector3<double>& point : points) {
    const Vector3<double> p_camera = frame_T_link * point;
    if (p_camera.z() > 2.0 || !is_in_image(driver, p_camera)) continue;
    look.seen.features.push_back({frame, recorded_point(driver, p_camera, {}, {}, random)});
    look.known.features.push_back({link, point});
  }
  return look;
}

}  // namespace kinecal::examples
