// Re-projection error (chain3d_to_camera2d): predicted pixel minus observed pixel.
//
//   r = predicted - observed
//
// Source: Fetch paper, III-B.  sensors/lens_camera.hpp has the projection.
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
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const PixelObservation<S>& pixel) const {
    return {pixel.predicted.x() - pixel.observed.x(), pixel.predicted.y() - pixel.observed.y()};
  }
};

}  // namespace kinecal
