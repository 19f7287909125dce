// The ranges of a laser scanner from messages: sensor_msgs/LaserScan.
//
// The point of beam i is (r cos a, r sin a, 0) in the scanner's frame, with a = angle_min + i angle_increment; the beam is measured
// at the stamp of the header + i time_increment.
// Source: package sensor_msgs; REP 117 (ranges that are not finite).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/capture/finders/wall_in_scan.hpp"
#include "kinecal/capture/view.hpp"
#include "kinecal/files/messages/value.hpp"

namespace kinecal::detail {

/// A scan of a message.
struct LaserScan {
  std::vector<double> ranges;  ///< metres, of each beam
  double first_angle = 0.0;    ///< of the first beam, radians, to the left of the scanner's x axis
  double step = 0.0;           ///< between two beams, radians
  double least = 0.0;          ///< the shortest range that counts, metres
  double most = 0.0;           ///< the longest range that counts, metres
  double time_step = 0.0;      ///< between two beams, seconds; zero: unknown, or absurd

  /// Its ranges, which live as long as this.
  [[nodiscard]] ScanRanges view() const { return {ranges, first_angle, step, least, most}; }
};

/// Reads a scan.
/// @throws std::runtime_error  if it has no ranges, its angles are not numbers, or no range can count
[[nodiscard]] LaserScan scan_of(const MessageFields& message);

/// Its points as a cloud of one row, in the scanner's frame; no_point() for a beam without a range that counts.
[[nodiscard]] PointCloud points_of(const LaserScan& scan);

/// The points of a PointCloud2 or LaserScan, as those of a view; of a scan with the time between them.
/// @throws std::runtime_error  if it cannot be read
void read_points(const MessageFields& message, View& view);

}  // namespace kinecal::detail
