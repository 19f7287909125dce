// Rounds of association for calibrations that compare masks with the outline of the robot (camera2d_to_mesh).
//
// 1. Coarse rounds on a few edges of the masks and simple meshes: what belongs together, a step, and again with a narrower
//    gate.  Where the pose of a camera is unknown, or the start ends badly, poses are searched for first
//    (surface/mask_search.hpp).
// 2. Fine rounds on all edges with the loss of the configuration: Levenberg-Marquardt on the true distances, until cost and
//    associations settle.  Without a loss, what is beyond four robust sigmas (at least kNarrowestGate) counts as strangers.
// 3. The samples get points of the outline as an ordinary observation, and the edges that belong to them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "kinecal/procedure/surface_blocks.hpp"
#include "kinecal/solve/fit_frames.hpp"

namespace kinecal {

/// Associates the masks of all samples with the outline of the robot.
/// @param number   of the step
/// @param blocks   its blocks of masks
/// @param config   such a block gets the noise that its edges show, if it has a loss
/// @param is_held  values stay: nothing is solved, and masks that do not show the robot are a doubt
/// @param samples  get the outline; edges that are not of the robot are left out
/// @param values   in: where rounds begin, of all parameters of the assembled table; out: where they ended
/// @param unknown  frames whose pose may be searched for
/// @param diagnostics  errors: masks that do not show the robot; notes: the fit, links that are always off
void match_outlines(const SurfaceInput& input, Config& config, std::size_t number,
                    std::span<const SurfaceBlock> blocks, bool is_held,
                    std::vector<Sample>& samples, Eigen::VectorXd& values,
                    std::span<const UnknownFrame> unknown, Diagnostics& diagnostics);

}  // namespace kinecal
