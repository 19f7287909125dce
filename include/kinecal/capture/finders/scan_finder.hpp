// The line of a laser scanner as features of a chain3d sensor.
//
// A scan is a cloud of one row.  A line does not determine a plane; repeated at several heights, it
// is a piece of a vertical wall in the scanner's frame.  Names and defaults are upstream's.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>

#include "kinecal/capture/finders/region.hpp"
#include "kinecal/capture/finders/view_checks.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Takes the points of a scan in a box.
struct ScanFinder {
  std::string sensor = "laser";  ///< chain3d sensor that observes the points (sensor_name)
  std::string frame;             ///< transform_frame of the features; empty: the scanner's own
  PoseOfView frame_T_scanner;    ///< needed if there is a frame
  /// (3) min_x, min_y, metres, in the scanner's frame, and its height.
  Vector3<double> least{-2.0, -2.0, -std::numeric_limits<double>::infinity()};
  Vector3<double> most{2.0, 2.0, std::numeric_limits<double>::infinity()};  ///< (3) max_x, max_y
  int z_repeats = 10;     ///< number of copies of each point, at least 1
  double z_offset = 0.1;  ///< metres along the scanner's z between repetitions

  /// The points of the scan.
  [[nodiscard]] Found find(const View& view) const;

  /// Why a view cannot be used, whatever it shows; empty if it can.
  [[nodiscard]] static std::string fault(const View& view) { return cloud_problem(view); }

  /// Link of the features; empty: the scanner's own frame.
  [[nodiscard]] const std::string& region_frame() const { return frame; }

  /// Takes the pose of the scanner in that link.
  void place_on(const CameraIn& camera_in) { frame_T_scanner = camera_in(frame); }
};
static_assert(Finder<ScanFinder>);

}  // namespace kinecal
