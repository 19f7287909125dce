// The robot of the workload: the Fetch's arm and head, with 26 parameters.
//
// From torso_lift_link, seven joints lead to wrist_roll_link; two joints and a camera mount lead to
// the optical frame of the head camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>

#include "kinecal/kinematics/robot.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "robots/fetch_bench_robot.hpp"

namespace kinecal::bench {

/// Eight joint offsets, a depth camera without its polynomial, two frames.
inline constexpr int kParameters = 8 + static_cast<int>(DepthCamera::kWithoutPolynomial) + 2 * 6;
static_assert(kParameters == 26);
inline constexpr int kLeds = 4;
inline constexpr int kRows = 3 * kLeds;  ///< residuals of one sample

inline const std::string kBase = "torso_lift_link";
inline const std::string kArmLink = "wrist_roll_link";
inline const std::string kCameraLink = "head_camera_rgb_optical_frame";

/// Joints with a frame correction.
inline const std::set<std::string> kFreeFrames = {"head_camera_rgb_joint", "head_pan_joint"};

[[nodiscard]] inline Mount arm_mount() {
  return {"arm", kArmLink};
}
[[nodiscard]] inline Mount camera_mount() {
  return {"camera", kCameraLink};
}

[[nodiscard]] inline Robot fetch_robot() {
  return robot_from<fetch::Robot>();
}

/// The free parameters, in the order of the Jacobian's columns: eight joint offsets (the zero of
/// head_pan_joint is in its frame), six of the depth camera, the frames of camera and head.
/// @param z_offset, z_scaling  of the depth driver while the samples were recorded: metres, factor
[[nodiscard]] inline ParameterTable fetch_parameters(double z_offset, double z_scaling) {
  ParameterTable table;
  for (const char* joint :
       {"shoulder_pan_joint", "shoulder_lift_joint", "upperarm_roll_joint", "elbow_flex_joint",
        "forearm_roll_joint", "wrist_flex_joint", "wrist_roll_joint", "head_tilt_joint"}) {
    table.add({.name = joint});
  }
  const std::string camera = camera_mount().parameter_prefix();
  add_parameters(table, camera,
                 std::span(DepthCamera::kParameters).first<DepthCamera::kWithoutPolynomial>());
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
