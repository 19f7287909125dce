// The pose of a printed target in a camera, from the corners in one view.
//
//   minimize  sum |f (x / z, y / z) - f ray(pixel)|^2     (x, y, z) = camera_T_target p
//
// in a camera that is turned to the middle of the corners, so that a lens may see them anywhere.
// A small or distant flat target looks nearly the same from two directions, one the reflection of the
// other across the line of sight.  Both are fitted.  If they fit alike, there is no pose.
// Source: Schweighofer, Pinz, Robust Pose Estimation from a Planar Target, 2006 (two minima).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// Where a target is, or why that is unknown.
struct TargetPose {
  std::optional<Pose<double>> camera_T_target;  ///< in the camera's optical frame
  double rms = 0.0;                             ///< of the corners, pixels
  std::string fault;                            ///< why there is no pose; empty if there is one
};

/// The two poses that fit a target.
struct TargetFit {
  Pose<double> pose;        ///< camera_T_target of the better one
  double cost = 0.0;        ///< its sum of squares
  Pose<double> other;       ///< the minimum near its reflection; the same if there is no second one
  double other_cost = 0.0;  ///< its sum of squares
};

/// Fits the poses of a target.  Four corners in a plane of constant z must be among its corners.
/// @param points      (3) each, metres, in the target
/// @param directions  (3) each, of any length, in the camera's optical frame: where it sees them
/// @param focal       unit of the sums: pixels per radian
/// @returns  nullopt if the corners do not determine it
[[nodiscard]] std::optional<TargetFit> fit_target(std::vector<Vector3<double>> points,
                                                  const std::vector<Vector3<double>>& directions,
                                                  double focal);

/// The pose of a target.  Four corners in a plane of constant z must be among its corners.
/// @param corners  of one target
/// @param camera   of the view; raw if it has a distortion, else rectified
[[nodiscard]] TargetPose target_pose(const std::vector<TargetCorner>& corners,
                                     const CameraInfo& camera);

}  // namespace kinecal
