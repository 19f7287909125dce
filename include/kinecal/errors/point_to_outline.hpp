// Distance in the image of the robot's outline from the edge of a mask (camera2d_to_mesh).  r = n . (predicted - observed)
//
// The point is one of the outline (surface/outline.hpp), a feature of a chain3d sensor on its link; the pixel is where the
// mask ends.  n is a unit vector in the image, found with both before the solve: the outline's normal, or the direction
// between the two where the outline ends.  It stays constant until they are associated anew.  As with chain3d_to_mesh, the
// gradient is that of the distance.
// Source: Drummond, Cipolla, Real-Time Visual Tracking of Complex Structures, 2002.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of an outline from the edge of a mask.
struct PointToOutline {
  static constexpr const char* kType = "camera2d_to_mesh";  ///< name in configurations
  static constexpr const char* kUnit = "px";                ///< of the residual
  /// The direction in which the distance counts, a unit vector in the image.
  static constexpr std::array<std::string_view, 2> kConditions = {"nu", "nv"};

  /// The distance.
  /// @param pixel  predicted: of the point of the outline; observed: where the mask ends
  /// @param n      nu nv
  /// @returns      (1) pixels; negative where the outline is inside of the mask, if n is the outline's normal
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const PixelObservation<S>& pixel,
                                                  const std::array<Q, 2>& n) const {
    return Eigen::Matrix<S, 1, 1>(n[0] * (pixel.predicted.x() - pixel.observed.x()) +
                                  n[1] * (pixel.predicted.y() - pixel.observed.y()));
  }
};

}  // namespace kinecal
