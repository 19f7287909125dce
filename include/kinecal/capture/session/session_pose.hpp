// What a capture session does in one pose, and what comes of it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/capture/session/settling.hpp"

namespace kinecal {

/// A finder of a session, with its camera.
struct SessionFinder {
  std::string name;                              ///< as poses name it
  std::function<View(Stamp after)> next_view;    ///< of its camera: see RobotCamera
  std::function<Found(const View& still)> find;  ///< receives a view in which nothing moves
  /// Why a view cannot be used, whatever it shows: no camera_info; empty: not asked.
  std::function<std::string(const View& view)> fault = {};
};

/// Settings of a session.
struct SessionOptions {
  double velocity_factor = 1.0;  ///< of the robot's usual speed, (0, 1]
  SettleOptions settling = {};   ///< when the robot counts as still
  double moved = 0.003;          ///< allowed joint motion while finders look, radians or metres
  bool look_first = true;        ///< at joints, cameras and clocks, before the first motion
  int hopeless = 3;              ///< poses that fail alike before any sample; 0: go on
  /// Why the first joint positions cannot be those of this robot: degrees; empty: not asked.
  std::function<std::string(const MeasuredJoints&)> fault = {};
};

/// The result of one finder in one pose.
struct FinderOutcome {
  std::string finder;  ///< its name
  View view;           ///< that it searched; without image if it was never still
  Found found;         ///< its features, or why they are missing
};

/// The result of one pose.
struct CapturedPose {
  CapturePose pose;                     ///< as requested
  std::vector<Sample> samples;          ///< empty if nothing was found; several if finders
                                        ///< observe with the same sensors
  std::vector<FinderOutcome> outcomes;  ///< of each finder that looked
  std::string failure;                  ///< why the pose was skipped; empty if it was not
  Stamp duration{};                     ///< of the move and the finders, on the robot's clock
};

}  // namespace kinecal
