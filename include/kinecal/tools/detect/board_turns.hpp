// Boards that look the same when they are turned: put right where the robot is known.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/capture/capture_config.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Links that camera and board are fixed to.
struct BoardLinks {
  std::string board;   ///< that holds the board; empty: the board's frame_id, if it is a link
  std::string camera;  ///< that holds the camera; empty: the frame of its features, if it is a link
};

/// Turns boards that look alike so that all samples show them the same way round.
/// @param diagnostics  receives what was turned as notes; a warning if that cannot be decided
void turn_boards(const std::vector<CaptureFinder>& finders, const std::optional<Robot>& robot,
                 const BoardLinks& links, std::vector<Sample>& samples, Diagnostics& diagnostics);

}  // namespace kinecal
