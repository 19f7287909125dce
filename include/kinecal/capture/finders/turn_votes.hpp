// Orientation of boards that look the same when rotated, by votes of all pairs of samples: see
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal::detail {

/// The rotations of boards to apply.
struct AgreedTurns {
  std::vector<int> turns;      ///< (n) quarter turns; most are 0
  std::vector<bool> doubtful;  ///< (n) true if another turn has nearly as many votes
};

/// The rotations on which most pairs agree.
/// @param links   (n) rotations of the camera's link in the link that holds the board
/// @param boards  (n) rotations of the board in the camera
/// @param step    quarter turns after which a board looks the same: 1 or 2
[[nodiscard]] AgreedTurns agreed_turns(const std::vector<Matrix3<double>>& links,
                                       const std::vector<Matrix3<double>>& boards, int step);

}  // namespace kinecal::detail
