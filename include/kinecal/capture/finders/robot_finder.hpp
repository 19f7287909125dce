// Points on the robot's own body, and on the ground it stands on.
//
// The cloud is split: a plane, and the points in the robot's box that are on the camera's side of
// the plane but not on it.  Two sensors observe them; names and defaults are upstream's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/finders/plane_finder.hpp"

namespace kinecal {

/// Finds points of a plane and of the robot itself.
struct RobotFinder {
  PlaneFinder plane;                          ///< its sensor observes the plane
  std::string robot_sensor = "camera_robot";  ///< observes the robot (robot_sensor_name)
  /// (3) min_robot_x to min_robot_z, metres, in the frame of the plane's region.
  Vector3<double> least{-2.0, -2.0, 0.0};
  Vector3<double> most{2.0, 2.0, 2.0};  ///< (3) max_robot_x to max_robot_z

  /// Points of the plane, then of the robot, in the optical frame; up to `plane.points_max` each.
  [[nodiscard]] Found find(const View& view) const;

  /// As that of the plane.
  [[nodiscard]] static std::string fault(const View& view) { return PlaneFinder::fault(view); }

  /// As that of the plane.
  [[nodiscard]] const std::string& region_frame() const { return plane.region_frame(); }

  /// As that of the plane.
  void place_on(const CameraIn& camera_in) { plane.place_on(camera_in); }
};
static_assert(Finder<RobotFinder>);

}  // namespace kinecal
