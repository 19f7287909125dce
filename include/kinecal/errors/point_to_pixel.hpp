// Re-projection error (chain3d_to_camera2d): predicted pixel minus observed pixel.
//
//   r = project(p_camera) - pixel
//
// Source: Fetch paper, III-B.  sensors/pinhole_camera.hpp has the projection.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Re-projection error of a point.
struct PointToPixel {
  static constexpr const char* kType = "chain3d_to_camera2d";  ///< name in configurations
  static constexpr const char* kUnit = "px";                   ///< of the residual

  /// The re-projection error.
  /// @returns  (2) pixels
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const Sight<S>& sight) const {
    const Eigen::Matrix<S, 2, 1> predicted = sight.camera.project(sight.p_camera, sight.parameters);
    return {predicted.x() - sight.pixel.x(), predicted.y() - sight.pixel.y()};
  }
};

}  // namespace kinecal
