// Configuration of a capture: robot_calibration's capture.yaml in both dialects.
//
//   chains:                                     which joints move, by which controllers
//   - {name: arm, topic: /arm_controller/follow_joint_trajectory, joints: [...]}
//   duration: 2.0                               of a motion, seconds
//   features:                                   what to look for, in which topics
//     led_finder: {type: robot_calibration/LedFinder, topic: ..., camera_sensor_name: camera, ...}
//
// In ROS 2, `chains` and `features` are lists of names, with a map for each beside them, all under
// <node>: ros__parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "kinecal/capture/finders/charuco_finder.hpp"
#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/capture/finders/circle_grid_finder.hpp"
#include "kinecal/capture/finders/led_finder.hpp"
#include "kinecal/capture/finders/mask_finder.hpp"
#include "kinecal/capture/finders/plane_finder.hpp"
#include "kinecal/capture/finders/robot_finder.hpp"
#include "kinecal/capture/finders/scan_finder.hpp"
#include "kinecal/capture/finders/touch_finder.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// Joints that one controller moves.
struct CaptureChain {
  std::string name;                 ///< for messages
  std::string topic;                ///< of the controller's action
  std::vector<std::string> joints;  ///< that it moves
};

/// Settings of any finder: itself, or what a `FinderType` is made from.
using FinderSettings =
    std::variant<LedFinder, CheckerboardSettings, AprilTagSettings, CharucoSettings,
                 CircleGridSettings, PlaneFinder, ScanFinder, RobotFinder, MaskFinder, TouchFinder>;

/// A finder and the source of its views.
struct CaptureFinder {
  std::string name;         ///< as poses name it
  std::string type;         ///< "LedFinder"
  std::string topic;        ///< of its images, clouds or scans
  std::string camera_info;  ///< topic of its camera's settings
  std::string action = {};  ///< switches LEDs
  FinderSettings settings;  ///< frames not yet on a robot: see on_robot()
  SourceLocation place;     ///< in the file
};

/// The content of a file.
struct CaptureConfig {
  std::vector<CaptureChain> chains;    ///< empty: every joint of a pose moves
  double duration = 2.0;               ///< shortest duration of a motion, seconds
  std::vector<CaptureFinder> finders;  ///< at least one
};

/// Reads a file.  All errors are collected; with errors the result is incomplete.
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] CaptureConfig read_capture_config(const std::string& path, Diagnostics& diagnostics);

/// The link in whose frame a finder searches; empty: the camera's own, or it searches images.
[[nodiscard]] std::string region_frame(const FinderSettings& settings);

/// Settings of a finder with regions and LEDs attached to a robot's links.
/// @throws InputError  naming a link that the robot does not have
[[nodiscard]] FinderSettings on_robot(const CaptureFinder& finder, const Robot& robot);

}  // namespace kinecal
