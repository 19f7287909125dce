// Position and velocity of moving joints at any moment between their readings.
//
//   q(t) = q0 + v t + a t^2 / 2,  by least squares; t = 0 at the moment
//
// A line would be wrong by the acceleration: at 1 rad/s^2 and +-60 ms, 0.6 mrad.  Both q0 and v are
// weighted sums of the readings, and the weights depend only on the stamps: a track has them once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/tools/detect/joint_track.hpp"

namespace kinecal::detail {

/// A joint at one moment.
struct JointMotion {
  double position = 0.0;  ///< radians or metres
  double velocity = 0.0;  ///< rad/s or m/s
};

/// Weights of the readings near a moment.
struct MotionWeights {
  std::size_t first = 0;         ///< index of the first reading
  std::size_t nearest = 0;       ///< index of the one nearest to the moment
  std::vector<double> position;  ///< of each reading, 1
  std::vector<double> velocity;  ///< of each reading, 1/s
};

/// Weights for a moment; nullopt if the readings do not say how the joints moved then.
/// @param track  sorted by stamps
[[nodiscard]] std::optional<MotionWeights> motion_weights(const JointTrack& track, Stamp stamp);

/// Position and velocity of a joint of the track.  A joint that crosses +-pi goes on beyond it.
[[nodiscard]] JointMotion motion_of(const JointTrack& track, std::size_t joint,
                                    const MotionWeights& weights);

/// Why there are no weights.
[[nodiscard]] std::string unknown_motion(const std::string& joint, const std::string& topic);

}  // namespace kinecal::detail
