// Frames of unknown pose that no sample ties to the robot: a camera that never sees what another sees, two arms that nothing
// relates.
//
//   base -- flange ~ board        ~ : a frame of unknown pose     -- : joints whose positions are recorded
//   base ~ camera                 what a sample compares (board and camera) hangs together
//
// Links hang together by joints and by what samples compare.  Board and camera above are tied to the robot, because their
// unknown frames are on parts that move against each other.  What hangs on one rigid part by unknown frames only may be anywhere.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Sensors that the samples compare only with each other.
struct FrameGap {
  std::vector<std::string> frames;   ///< of unknown pose, between them and the rest
  std::vector<std::string> sensors;  ///< theirs
  std::vector<std::string> others;   ///< sensors that are tied to the base
};

/// The groups that nothing ties to the base.
/// @param unknown  names of the frames of unknown pose, of step.free_frames
[[nodiscard]] std::vector<FrameGap> frame_gaps(const Robot& robot, const std::string& base,
                                               const StepConfig& step,
                                               const std::vector<std::string>& unknown,
                                               std::span<const Sample> samples);

/// Reports them, with what would close them.
void check_frame_gaps(const Robot& robot, const std::string& base, const StepConfig& step,
                      const std::vector<std::string>& unknown, std::span<const Sample> samples,
                      Diagnostics& diagnostics);

}  // namespace kinecal
