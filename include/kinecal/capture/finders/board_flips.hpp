// Resolves the orientation of boards that look the same when rotated, over a whole session.
//
// Let M be the pose of the camera's link in the link that holds the board, from the joints, and B
// the board's pose in the camera.  Wherever camera and board are mounted, for two samples i and j
//
//   M_j^-1 M_i  and  B_j B_i^-1   rotate by the same angle:
//
// they are one motion in two frames.  If board i is rotated about its normal against board j, the
// angles almost always differ.  So each pair of samples votes on its relative rotation, and the
// rotations with the most votes win.  This needs no calibration: a nominal robot is enough, and
// neither mount must be known.
// Source: Shiu and Ahmad, Calibration of Wrist-Mounted Robotic Sensors, 1989 (A X = X B).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/capture/finders/checkerboard_finder.hpp"
#include "kinecal/capture/finders/circle_grid_finder.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// A board that may look the same when rotated.
struct AlikeBoard {
  int columns = 0, rows = 0;  ///< of corners, or of the centres of discs
  int turns = 4;  ///< quarter turns after which it looks the same: 1, 2; 4 if it does not
  TargetSettings target = {};
  std::string called = {};  ///< "a board of 8x6 corners"
  std::string better = {};  ///< one that does not: "a board of which points_x + points_y is odd"
};

/// A checkerboard as such a board.
[[nodiscard]] AlikeBoard alike_board(const CheckerboardSettings& board);

/// A grid of discs as such a board.
[[nodiscard]] AlikeBoard alike_board(const CircleGridSettings& grid);

/// Rotations of boards.
struct Flips {
  std::vector<int> quarter_turns;      ///< of each sample's board: 0 if unchanged or absent
  std::vector<std::size_t> undecided;  ///< samples whose board fits two orientations equally well
};

/// Rotates boards of ambiguous orientation so that all samples agree.  The orientation of most
/// samples stays.  Ignores samples without both sensors, or with only a part of the board.
/// @param samples             the camera's features are renumbered
/// @param board               its size and its sensors, as its finder has them
/// @param board_T_camera_link per sample: pose of the camera's link in the link that holds the
/// board,
///                            from the joints
/// @throws std::invalid_argument  if the numbers of poses and samples differ
Flips resolve_flips(std::span<Sample> samples, const AlikeBoard& board,
                    std::span<const Pose<double>> board_T_camera_link);

/// Poses of one link in another, from the joints of each sample and a nominal robot.
/// @throws RobotError  if no chain connects them;  std::invalid_argument  if a joint was not
///                     measured
[[nodiscard]] std::vector<Pose<double>> link_poses(const Robot& robot, const std::string& in,
                                                   const std::string& link,
                                                   std::span<const Sample> samples);

}  // namespace kinecal
