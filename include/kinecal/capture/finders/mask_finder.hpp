// The edges of a mask as features: where the robot ends in a picture that some program has segmented.
//
// A mask is an image in which 255 is the robot and 0 is not.  Only the camera observes its edges: where the outline of the
// robot is, its meshes say (surface/outline.hpp).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

/// Pixels at the border of an image in which no edge is looked for: it may be that of the image.
inline constexpr int kMaskBorder = 3;

/// A place at which a mask ends.
struct MaskEdge {
  Eigen::Vector2d pixel;   ///< (2) between a pixel of the robot and one beside it
  Eigen::Vector2d normal;  ///< (2) unit vector, away from the robot, of some pixels around
};

/// The edges of a mask, without those within kMaskBorder of the image's border.
/// @param mask  128 and more: robot
[[nodiscard]] std::vector<MaskEdge> mask_edges(const GrayImage& mask);

/// Finds the edges of masks.
struct MaskFinder {
  std::string camera_sensor = "camera";  ///< sensor that observes pixels

  /// The edges, without ids; their normals are conditions nu, nv.
  [[nodiscard]] Found find(const View& view) const;

  /// Why a view is no mask; empty if it may be one.
  [[nodiscard]] static std::string fault(const View& view);
};
static_assert(Finder<MaskFinder>);

}  // namespace kinecal
