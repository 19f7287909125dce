// The Fetch's arm and head in code: the robot whose calibration is measured, and its 26 parameters.
//
// Lengths and axes of the Fetch from torso_lift_link on: seven joints to wrist_roll_link, two and a
// camera mount to the optical frame of the head camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>

#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal::bench {

inline constexpr int kParameters = 26;
inline constexpr int kLeds = 4;
inline constexpr int kRows = 3 * kLeds;  ///< residuals of one sample

inline const std::string kBase = "torso_lift_link";
inline const std::string kArmLink = "wrist_roll_link";
inline const std::string kCameraLink = "head_camera_rgb_optical_frame";

/// Joints with a frame correction.
inline const std::set<std::string> kFreeFrames = {"head_camera_rgb_joint", "head_pan_joint"};

[[nodiscard]] inline Sensor arm_sensor() {
  return {"arm", SensorType::chain3d, kArmLink, ""};
}
[[nodiscard]] inline Sensor camera_sensor() {
  return {"camera", SensorType::camera3d, kCameraLink, ""};
}

namespace detail {

/// A turning joint; those without limits are continuous.
[[nodiscard]] inline Joint turning(const std::string& name, const std::string& parent,
                                   const std::string& child, const Vector3<double>& xyz,
                                   const Vector3<double>& axis,
                                   std::optional<JointLimits> limits = {}) {
  return {name,
          limits ? JointType::revolute : JointType::continuous,
          parent,
          child,
          {Matrix3<double>::Identity(), xyz},
          axis,
          {},
          limits};
}

[[nodiscard]] inline Joint mount(const std::string& name, const std::string& parent,
                                 const std::string& child, const Vector3<double>& xyz,
                                 const Vector3<double>& rpy = {0, 0, 0}) {
  return {name, JointType::fixed, parent, child, {rotation_from_rpy(rpy), xyz}};
}

[[nodiscard]] inline std::vector<Joint> arm_joints() {
  const Vector3<double> x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  return {
      turning("shoulder_pan_joint", kBase, "shoulder_pan_link", {0.119525, 0, 0.34858}, z,
              JointLimits{-1.6056, 1.6056}),
      turning("shoulder_lift_joint", "shoulder_pan_link", "shoulder_lift_link",
              {0.117, 0, 0.0599999999999999}, y, JointLimits{-1.221, 1.518}),
      turning("upperarm_roll_joint", "shoulder_lift_link", "upperarm_roll_link", {0.219, 0, 0}, x),
      turning("elbow_flex_joint", "upperarm_roll_link", "elbow_flex_link", {0.133, 0, 0}, y,
              JointLimits{-2.251, 2.251}),
      turning("forearm_roll_joint", "elbow_flex_link", "forearm_roll_link", {0.197, 0, 0}, x),
      turning("wrist_flex_joint", "forearm_roll_link", "wrist_flex_link", {0.1245, 0, 0}, y,
              JointLimits{-2.16, 2.16}),
      turning("wrist_roll_joint", "wrist_flex_link", kArmLink, {0.1385, 0, 0}, x),
  };
}

[[nodiscard]] inline std::vector<Joint> head_joints() {
  const Vector3<double> y(0, 1, 0), z(0, 0, 1);
  constexpr double kQuarterTurn = 1.57079632679;  // as the robot's description rounds it
  return {
      turning("head_pan_joint", kBase, "head_pan_link", {0.053125, 0, 0.603001417713939}, z,
              JointLimits{-1.57, 1.57}),
      turning("head_tilt_joint", "head_pan_link", "head_tilt_link", {0.14253, 0, 0.057999}, y,
              JointLimits{-0.76, 1.45}),
      mount("head_camera_joint", "head_tilt_link", "head_camera_link", {0.055, 0, 0.0225}),
      mount("head_camera_rgb_joint", "head_camera_link", "head_camera_rgb_frame", {0, 0.02, 0}),
      mount("head_camera_rgb_optical_joint", "head_camera_rgb_frame", kCameraLink, {0, 0, 0},
            {-kQuarterTurn, 0, -kQuarterTurn}),
  };
}

}  // namespace detail

[[nodiscard]] inline Robot fetch_robot() {
  std::vector<Joint> joints = detail::arm_joints();
  for (const Joint& joint : detail::head_joints()) joints.push_back(joint);
  return Robot("fetch_arm_head", std::move(joints));
}

/// What may be wrong, in the order of the Jacobian's columns: eight joint offsets (the zero of
/// head_pan_joint is in its frame), six of the depth camera, the frames of camera and head.
/// @param z_offset, z_scaling  of the depth driver while the samples were recorded: metres, factor
[[nodiscard]] inline ParameterTable fetch_parameters(double z_offset, double z_scaling) {
  ParameterTable table;
  for (const char* joint :
       {"shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
        "forearm_roll_joint", "wrist_flex_joint", "wrist_roll_joint", "head_tilt_joint"}) {
    table.add({.name = joint});
  }
  const std::string camera = camera_sensor().parameter_prefix();
  for (const auto part : kCameraParameters) {
    table.add({.name = parameter_name(camera, part), .unit = part == "z_offset" ? "m" : "1"});
  }
  for (const char* frame : {"head_camera_rgb_joint", "head_pan_joint"}) {
    for (std::size_t axis = 0; axis < 6; ++axis) {
      table.add({.name = parameter_name(frame, kFrameAxes[axis]), .unit = axis < 3 ? "m" : "rad"});
    }
  }
  const auto start = [&](const char* part, double value) {
    Parameter& parameter = table[parameter_name(camera, part)];
    parameter.initial = parameter.value = value;
  };
  start("z_offset", z_offset);
  start("z_scaling", z_scaling - 1.0);
  return table;
}

}  // namespace kinecal::bench
