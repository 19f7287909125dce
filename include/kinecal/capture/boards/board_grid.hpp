// The grid of a flat target where its corners put it, for pictures.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/capture/boards/board_fit.hpp"
#include "kinecal/capture/view.hpp"

namespace kinecal {

/// Lines from the fitted place of each corner to those of its neighbours, to the right and up on the target.  So
/// a corner that was not found where it is lies beside its lines.
/// @param fit  of the corners; without places there are no lines
[[nodiscard]] std::vector<GridLine> board_grid(const std::vector<TargetCorner>& corners,
                                               const BoardFit& fit);

}  // namespace kinecal
