// An order of poses that shortens the robot's path.
//
// A move takes as long as its slowest joint: max |dq| / speed.  From the start, the nearest pose
// always comes next; then parts of the path are reversed while that shortens it.
// Source: Croes, A Method for Solving Traveling-Salesman Problems, 1958 (2-opt).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace kinecal {

/// Positions of the same joints in each pose, radians or metres.
using JointPlaces = std::vector<std::vector<double>>;

/// Seconds from pose to pose in this order, without stops.
/// @param speeds  of each joint, radians or metres per second
[[nodiscard]] double motion_time(const JointPlaces& places, const std::vector<int>& order,
                                 const std::vector<double>& speeds);

/// The same poses in a shorter order, never a longer one; the first pose stays first.
/// @throws std::invalid_argument  if a pose has more or fewer joints than there are speeds, or a
///                                speed is not positive
[[nodiscard]] std::vector<int> motion_order(const JointPlaces& places,
                                            const std::vector<int>& poses,
                                            const std::vector<double>& speeds);

}  // namespace kinecal
