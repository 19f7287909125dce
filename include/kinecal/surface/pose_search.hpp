// The pose of a camera that sees the robot, from nothing: which rigid motion lays clouds on the posed surface.
//
// 1. The surface of each sample becomes a grid of distances, up to a limit.
// 2. Rotations from an even grid; the translation brings the middles of clouds to those of surfaces.  Middles of all points,
//    and of those that moved between samples: background stands still, if the camera does.
// 3. The best go downhill in the distances; those that end apart are returned, the best first.
// Source: Felzenszwalb, Huttenlocher, Distance Transforms of Sampled Functions, 2012.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/surface/robot_surface.hpp"

namespace kinecal {

/// One sample of a search: a cloud, and the robot that it is of.
struct PosedCloud {
  std::vector<Vector3<double>> points;  ///< (3) metres, in the frame whose pose is unknown
  std::vector<Pose<double>> links;      ///< of the surface, in the frame in which the pose is given
};

/// How a search for a pose goes.
struct SurfaceSearch {
  int rotations = 3000;  ///< of the grid
  int points = 60;       ///< of each cloud
  int samples = 6;       ///< at most
  int refined = 80;      ///< poses that go downhill
  int kept = 8;          ///< poses that are returned
};

/// Poses under which the clouds lie on the surface, the best first.
/// @returns  parent_T_frame: of the frame of the points in that of the links
[[nodiscard]] std::vector<Pose<double>> find_poses(const RobotSurface& surface,
                                                   std::span<const PosedCloud> samples,
                                                   const SurfaceSearch& search = {});

}  // namespace kinecal
