// Which way round a board is that looks the same when it is turned, decided over a whole session.
//
// Let M be the pose of the camera's link in the link that holds the board, by the joints, and B the
// board's pose in the camera.  Wherever camera and board are mounted, for two samples i and j
//
//   M_j^-1 M_i  and  B_j B_i^-1   turn by the same angle:
//
// they are one motion in two frames.  If board i is turned about its normal against board j, the angle
// differs nearly always.  So each pair of samples says how they are turned to each other, and the turns
// are those with which most pairs agree.  It needs no calibration: a nominal robot will do, and neither
// mount must be known.
// Source: Shiu and Ahmad, Calibration of Wrist-Mounted Robotic Sensors, 1989 (A X = X B).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/capture/checkerboard_finder.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// How boards were turned.
struct Flips {
  std::vector<int> quarter_turns;      ///< of each sample's board: 0 if it stayed, or is not there
  std::vector<std::size_t> undecided;  ///< samples whose board fits two ways about as well
};

/// Turns boards that look alike so that all samples show them the same way round.  What most samples
/// have stays.  Samples without both sensors, or with a part of the board only, are left alone.
/// @param samples             the camera's features are renumbered
/// @param board               its size and its sensors, as its finder has them
/// @param board_T_camera_link per sample: pose of the camera's link in the link that holds the board,
///                            from the joints
/// @throws std::invalid_argument  if there are not as many poses as samples
Flips resolve_flips(std::span<Sample> samples, const CheckerboardSettings& board,
                    std::span<const Pose<double>> board_T_camera_link);

/// Poses of one link in another, from the joints of each sample and a robot as its URDF says.
/// @throws RobotError  if no chain joins them;  std::invalid_argument  if a joint was not measured
[[nodiscard]] std::vector<Pose<double>> link_poses(const Robot& robot, const std::string& in,
                                                   const std::string& link,
                                                   std::span<const Sample> samples);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/board_flips.ipp"
#endif
