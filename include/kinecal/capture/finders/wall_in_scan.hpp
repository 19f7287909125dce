// The wall in front of a laser scanner: a line through most of the points of a scan.
//
// The line with most points near it is found among those through pairs of points, then fitted to its points by least squares
// of distances.  A scan that shows no wall is refused with what it shows.  The window and its defaults are those of
// base_calibration of robot_calibration.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace kinecal {

/// Ranges of a scan, as of sensor_msgs/LaserScan.
struct ScanRanges {
  std::span<const double> ranges;  ///< metres; not finite where nothing was hit
  double first_angle = 0.0;  ///< of the first one, radians, to the left of the scanner's x axis
  double step = 0.0;         ///< between two of them, radians
  double least = 0.0;        ///< the shortest range that counts, metres
  double most = 100.0;       ///< the longest range that counts, metres

  /// The direction of a range, radians, to the left of the scanner's x axis; not within any turn.
  [[nodiscard]] double angle(std::size_t i) const {
    return first_angle + static_cast<double>(i) * step;
  }
  /// True if something was hit within the ranges that count.
  [[nodiscard]] bool counts(std::size_t i) const {
    const double range = ranges[i];
    return std::isfinite(range) && range > 0.0 && range >= least && range <= most;
  }
};

/// Where a wall is looked for, and what counts as one.
struct WallWindow {
  double min_angle = -0.5;    ///< radians
  double max_angle = 0.5;     ///< radians
  double thickness = 0.03;    ///< of the points of a wall, metres to either side
  double least_share = 0.5;   ///< of the points in the window that are on the wall
  double angle_known = 0.01;  ///< standard deviation of its angle, at most, radians
};

/// A wall, in the frame of the scanner.
struct ScanWall {
  double angle =
      0.0;  ///< of the direction in which it is nearest, radians, to the left of the x axis
  double distance = 0.0;  ///< there, metres
  double scatter = 0.0;   ///< of its points about the line, metres
  int points = 0;         ///< on it
};

/// A wall, or why there is none.
struct FoundWall {
  std::optional<ScanWall> wall;
  std::string refusal;  ///< a sentence; empty if there is a wall
};

/// Looks for the wall.
[[nodiscard]] FoundWall wall_in_scan(const ScanRanges& scan, const WallWindow& window = {});

}  // namespace kinecal
