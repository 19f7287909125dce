// A scene in code: a robot with an arm, an RGB-D camera, a colour camera and a ground, its
// parameters, and samples of it that can be made without noise for any parameter values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "support/camera_infos.hpp"
#include "support/double_problem.hpp"
#include "support/oracle.hpp"
#include "support/robots.hpp"

namespace kinecal::test {

/// The offsets, frames and camera parameters of the scene, all at zero.
inline ParameterTable scene_table() {
  ParameterTable table;
  for (const char* joint : {"torso_joint", "shoulder_pan", "shoulder_lift", "elbow", "wrist",
                            "head_pan", "head_tilt"}) {
    table.add({.name = joint});
  }
  for (const char* frame : {"head_pan", "camera_joint", "elbow_mount", "board"}) {
    for (auto axis : kFrameAxes) table.add({.name = parameter_name(frame, axis)});
  }
  for (const ParameterInfo& info :
       std::span(DepthCamera::kParameters).first(DepthCamera::kWithoutPolynomial)) {
    table.add({.name = parameter_name("camera", info.name)});
  }
  for (const ParameterInfo& info : std::span(PinholeCamera::kParameters).first(kIntrinsics)) {
    table.add({.name = parameter_name("eye", info.name)});
  }
  return table;
}

inline const std::set<std::string> kSceneFrames = {"head_pan", "camera_joint", "elbow_mount",
                                                   "board"};

/// A problem with all sensors of the scene and no error blocks yet.
template <class S = Packet>
BasicProblem<S> scene_problem(const std::string& base = "base_link") {
  BasicProblem<S> problem(mobile_manipulator(), base, scene_table(), kSceneFrames);
  problem.add_sensor(ChainPoint{}, {"arm", "hand"});
  problem.add_sensor(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem.add_sensor(PinholeCamera{}, {"eye", "camera_optical_frame"});
  return problem;
}

/// Number of batches of all layouts.
template <class S>
std::ptrdiff_t count_batches(const BasicProblem<S>& problem) {
  std::size_t n = 0;
  for (const detail::Batches<S>& batches : problem.batches()) n += batches.size();
  return static_cast<std::ptrdiff_t>(n);
}

/// Random values of the scene's parameters.
/// @param scale  of angles (rad), lengths are a tenth, camera parameters a hundredth of it
inline std::vector<double> random_values(const ParameterTable& table, double scale, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> values;
  for (const Parameter& parameter : table) {
    const std::string& name = parameter.name;
    const bool length = name.ends_with("_x") || name.ends_with("_y") || name.ends_with("_z") ||
                        name == "torso_joint";
    const bool camera = name.starts_with("camera_") && !name.starts_with("camera_joint");
    const double size = camera || name.starts_with("eye_") ? 0.01 : length ? 0.1 : 1.0;
    values.push_back(scale * size * normal(random));
  }
  return values;
}

/// The pose in the base of a frame of a sensor in a sample, at the given values, by the oracle.
template <class S>
Pose<double> tip_pose(const BasicProblem<S>& problem, std::size_t sensor, const std::string& frame,
                      const Sample& sample, std::span<const double> values) {
  const MountedSensor& model = problem.sensors()[sensor];
  const OraclePose<double> pose =
      oracle_pose(mobile_manipulator(), model.chains().front().chain().base, model.mount().frame,
                  frame, sample, OracleValues<double>(problem.table(), values));
  return {pose.r, pose.t};
}

/// The depth z1 with z = z1 (1 + z_quadratic z1 + p), where p is the rest of the polynomial.
inline double depth_before_polynomial(double z, double x, double y,
                                      const OracleValues<double>& value) {
  const double p = value("camera_z_x") * x + value("camera_z_y") * y +
                   value("camera_z_xx") * x * x + value("camera_z_xy") * x * y +
                   value("camera_z_yy") * y * y;
  return 2.0 * z /
         (1.0 + p + std::sqrt((1.0 + p) * (1.0 + p) + 4.0 * value("camera_z_quadratic") * z));
}

/// Adds the coefficients of the depth camera's polynomial to a table of the scene.
inline void add_depth_polynomial(ParameterTable& table) {
  for (const ParameterInfo& info : kDepthPolynomial) {
    table.add({.name = parameter_name("camera", info.name), .unit = std::string(info.unit)});
  }
}

/// Samples that fit the problem's robot exactly at the given values: joint positions are random,
/// each feature is a point in front of the camera, as camera and arm must then have seen it.
template <class S>
std::vector<Sample> exact_samples(const BasicProblem<S>& problem, std::span<const double> values,
                                  int count, const std::string& arm_frame = "hand",
                                  unsigned seed = 1, int features = 4) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> side(-0.3, 0.3), depth(0.5, 1.2);
  std::vector<Sample> samples;
  const CameraInfo info = camera_info();
  const Robot robot = mobile_manipulator();
  const OracleValues<double> value(problem.table(), values);
  for (int n = 0; n < count; ++n) {
    Sample sample;
    sample.source = "scene:" + std::to_string(n);
    RandomPositions positions(seed * 1000 + static_cast<unsigned>(n));
    for (const Joint& joint : robot.joints()) {
      if (!moves(joint.type) || joint.mimic) continue;
      sample.joint_names.push_back(joint.name);
      sample.joint_positions.push_back(positions(joint.name));
    }
    const auto tip = [&](std::size_t sensor, const std::string& frame) {
      return tip_pose(problem, sensor, frame, sample, values);
    };
    Observation arm{"arm", {}}, depth_camera{"camera", {}, info}, pinhole{"eye", {}, info};
    for (int f = 0; f < features; ++f) {
      const double z = depth(random);
      const Vector3<double> seen{side(random) * z, side(random) * z, z};  // braces: in this order
      // The raw pixel and depth that mean this point at these camera parameters.
      const double u =
          seen.x() / z * 550 * (1 + value("camera_fx")) + 320 * (1 + value("camera_cx"));
      const double v =
          seen.y() / z * 545 * (1 + value("camera_fy")) + 240 * (1 + value("camera_cy"));
      const double x = (u - 320) / 550, y = (v - 240) / 545;
      const double z1 = depth_before_polynomial(z, x, y, value);
      const double z0 = z1 / (1.0 + value("camera_z_scaling")) - value("camera_z_offset");
      const Vector3<double> recorded((u - 320) * z0 / 550, (v - 240) * z0 / 545, z0);
      depth_camera.features.push_back({"camera_optical_frame", recorded});
      const Vector3<double> p_base = tip(1, "camera_optical_frame") * seen;
      arm.features.push_back({arm_frame, tip(0, arm_frame).inverse() * p_base});
      const Eigen::Vector2d pixel = oracle_pixel(info, seen, "eye", value);
      pinhole.features.push_back({"camera_optical_frame", {pixel.x(), pixel.y(), 0}});
    }
    sample.observations = {arm, depth_camera, pinhole};
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace kinecal::test
