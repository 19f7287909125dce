// Planes and lines that many points of a sample lie on (point_on_plane, point_on_line): a wall that a laser sees, a board.
//
// Blocks pair features, so a plane needs one for each point.  A single feature is that of every point.  If no sample says anything
// of a plane, it is where the frame of its model is, in samples in which three points or more without ids are seen.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Gives planes and lines a feature for each point.
/// @param samples  those in which the points are seen; others stay
void place_planes(const Config& config, std::vector<Sample>& samples);

}  // namespace kinecal
