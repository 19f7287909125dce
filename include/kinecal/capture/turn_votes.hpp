// Turns of boards that look alike, by the votes of all pairs of samples: see board_flips.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal::detail {

/// How boards are to be turned.
struct AgreedTurns {
  std::vector<int> turns;      ///< (n) quarter turns; most are 0
  std::vector<bool> doubtful;  ///< (n) true if another turn has nearly as many votes
};

/// The turns with which most pairs agree.
/// @param links   (n) rotations of the camera's link in the link that holds the board
/// @param boards  (n) rotations of the board in the camera
/// @param step    quarter turns that look alike: 1 or 2
[[nodiscard]] AgreedTurns agreed_turns(const std::vector<Matrix3<double>>& links,
                                       const std::vector<Matrix3<double>>& boards, int step);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/turn_votes.ipp"
#endif
