// The keys of a calibration's settings in a launch file, and their names there.
//
// The keys are fixed; the names differ from robot to robot, with Fetch's as defaults.  A key with
// an empty name is not set.  The keys of a second camera begin with its name
// (left_rgb_camera_info_url); their names in a launch file are unknown, so they have no default.
// Source: Fetch paper, III-C; the launch file of the Fetch robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Name of a <param> or <arg> for each key.
using LaunchNames = std::map<std::string, std::string>;

namespace launch_key {
inline constexpr std::string_view kDate = "calibration_date";    ///< date of the calibration
inline constexpr std::string_view kRobot = "robot_description";  ///< file of the URDF
inline constexpr std::string_view kDepthOffset = "z_offset_mm";  ///< depth offset, millimetres
inline constexpr std::string_view kDepthScaling = "z_scaling";   ///< depth scale, a factor
/// File of the depth camera.
inline constexpr std::string_view kDepthInfo = "depth_camera_info_url";
inline constexpr std::string_view kRgbInfo = "rgb_camera_info_url";  ///< file of the color camera
inline constexpr std::string_view kTrackWidth = "track_width";       ///< of the base, metres
inline constexpr std::string_view kGyroScale = "gyro_scale";  ///< factor of the gyroscope's driver
/// All keys.
inline constexpr std::array kAll = {kDate,      kRobot,   kDepthOffset, kDepthScaling,
                                    kDepthInfo, kRgbInfo, kTrackWidth,  kGyroScale};
}  // namespace launch_key

/// The names in the launch file of the Fetch robot, for every key.
[[nodiscard]] LaunchNames fetch_launch_names();

/// Fetch's names, except those given by the user.
/// @param given        "KEY=NAME" each; "KEY=" for a key not to set
/// @throws InputError  for a text without '=', an unknown key, or a key given twice
[[nodiscard]] LaunchNames launch_names(const std::vector<std::string>& given);

}  // namespace kinecal
