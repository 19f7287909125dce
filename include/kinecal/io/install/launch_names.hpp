// What a calibration sets in a launch file, by key, and how the launch file calls it.
//
// The keys are fixed, the names differ from robot to robot; Fetch's are the default.  A key whose
// name is empty is not set.  Of a second camera the keys begin with its name
// (left_rgb_camera_info_url); nobody knows how a launch file calls those, so they have no default.
// Source: Fetch paper, III-C; the launch file of the Fetch robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/kinematics/nearest_name.hpp"

namespace kinecal {

/// Name of a <param> or <arg> for each key.
using LaunchNames = std::map<std::string, std::string>;

namespace launch_key {
inline constexpr std::string_view kDate = "calibration_date";
inline constexpr std::string_view kRobot = "robot_description";
inline constexpr std::string_view kDepthOffset = "z_offset_mm";
inline constexpr std::string_view kDepthScaling = "z_scaling";
inline constexpr std::string_view kDepthInfo = "depth_camera_info_url";
inline constexpr std::string_view kRgbInfo = "rgb_camera_info_url";
inline constexpr std::array kAll = {kDate,         kRobot,     kDepthOffset,
                                    kDepthScaling, kDepthInfo, kRgbInfo};
}  // namespace launch_key

[[nodiscard]] inline LaunchNames fetch_launch_names() {
  LaunchNames names;
  for (const std::string_view key : launch_key::kAll) names.emplace(key, key);
  names["z_offset_mm"] = "head_camera/driver/z_offset_mm";
  names["z_scaling"] = "head_camera/driver/z_scaling";
  return names;
}

/// Fetch's names, but for those that the user gave.
/// @param given        "KEY=NAME" each; "KEY=" for what is not to be set
/// @throws InputError  for what has no '=', an unknown key or a key that is given twice
[[nodiscard]] inline LaunchNames launch_names(const std::vector<std::string>& given) {
  LaunchNames own;
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) {
      throw InputError("name '" + text + "': is not KEY=NAME; KEY= leaves a key out");
    }
    const std::string key = text.substr(0, equals);
    bool known = false;
    for (const std::string_view k : launch_key::kAll) {
      known = known || key == k || key.ends_with("_" + std::string(k));
    }
    if (!known) {
      throw InputError("name '" + text + "': '" + key + "' is not a key" +
                       did_you_mean(key, launch_key::kAll));
    }
    if (!own.emplace(key, text.substr(equals + 1)).second) {
      throw InputError("name '" + text + "': '" + key + "' is named twice");
    }
  }
  own.merge(fetch_launch_names());  // keeps what is there
  return own;
}

}  // namespace kinecal
