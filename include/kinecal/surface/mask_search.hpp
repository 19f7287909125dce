// The pose of a camera from masks of the robot, from nothing: where must it stand to see these outlines?
//
// 1. Rotations from an even grid; the spread of the robot across the line of sight and that of its mask give the distance,
//    their middles the direction.
// 2. A pose is judged by points of the robot that are outside of the masks, and by parts of the masks without the robot;
//    it is shifted while that helps.
// 3. The best go downhill on coarse outlines, both ways; those that end apart are returned, the best first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/surface/outline.hpp"

namespace kinecal {

/// One sample of a search: the mask that a camera sees, and the robot that it is of.
struct PosedMask {
  std::vector<MaskEdge> edges;  ///< in an ideal camera: pixel (x / z, y / z)
  Eigen::Vector2d low, high;  ///< (2) corners of the image there: what is outside of it has no mask
  std::vector<Pose<double>> links;  ///< of the surface, in the frame in which the pose is given
};

/// How such a search goes.
struct MaskSearch {
  int rotations = 1000;  ///< of the grid
  int samples = 6;       ///< at most
  int shifted = 200;     ///< of these, that are shifted by finer steps
  int refined = 100;     ///< of these, that go downhill, at most
  int kept = 4;          ///< of these, that are returned
};

/// Poses of a camera that sees these masks, the best first.
/// @returns  parent_T_camera: of the camera, its z axis ahead, in the frame of the links
[[nodiscard]] std::vector<Pose<double>> find_camera_poses(const RobotSurface& surface,
                                                          std::span<const PosedMask> samples,
                                                          const MaskSearch& search = {});

}  // namespace kinecal
