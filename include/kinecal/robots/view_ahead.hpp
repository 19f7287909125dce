// What laser scanners show ahead of a base, whichever way they are mounted.
//
// The direction of beam a is base_R_scanner (cos a, sin a, 0).  It looks ahead if it is level and within half a radian of the
// base's x axis.  Where a scanner is mounted is in /tf_static; of one that is mounted somewhere else, nothing is known.
// Source: REP 103 (x is ahead), REP 117 (-inf: something is nearer than the scanner can measure).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>

#include "kinecal/capture/finders/wall_in_scan.hpp"
#include "kinecal/files/messages/scan_message.hpp"
#include "kinecal/files/messages/value.hpp"
#include "kinecal/files/recordings/fixed_frames.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/robots/ros_base.hpp"

namespace kinecal::detail {

/// The nearest range ahead, metres, from the scanner; zero if something is nearer than it can measure, infinite if there is
/// nothing.
/// @returns  nullopt if the scan does not show 0.2 rad to either side of what is ahead
[[nodiscard]] std::optional<double> nearest_ahead(const ScanRanges& scan,
                                                  const Matrix3<double>& base_R_scanner);

/// The newest scans of a base.
class ViewAhead {
 public:
  /// Takes a message of /tf_static.
  void take_frames(const MessageFields& message) { frames_.add(message); }
  /// Takes a sensor_msgs/LaserScan.  One that cannot be read is left out.
  void take_scan(const std::string& topic, const MessageFields& message,
                 std::chrono::steady_clock::time_point arrival);

  /// The nearest of all scanners, as old as the oldest scan.
  /// @param base  its frame: child_frame_id of the odometry
  /// @returns  nullopt if no scan is known to show what is ahead
  [[nodiscard]] std::optional<RosBase::Ahead> ahead(const std::string& base) const;

  /// Why nothing is known of what is ahead.
  [[nodiscard]] std::string why_none(const std::string& base) const;

 private:
  struct Scan {
    LaserScan ranges;
    std::string frame;
    std::chrono::steady_clock::time_point arrival;
  };
  std::map<std::string, Scan> scans_;  ///< by topic
  FixedFrames frames_;
};

}  // namespace kinecal::detail
