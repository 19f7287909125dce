// Re-projection (chain3d_to_camera2d): where a camera should see a point, less where it saw it.
//
//   r = project(p_camera) - pixel
//
// Source: Fetch paper, III-B; sensors/pinhole_camera.hpp for the projection
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

struct PointToPixel {
  static constexpr const char *kType = "chain3d_to_camera2d", *kUnit = "px";

  /// @returns  (2) pixels
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const Sight<S>& sight) const {
    const Eigen::Matrix<S, 2, 1> predicted = sight.camera.project(sight.p_camera, sight.parameters);
    return {predicted.x() - sight.pixel.x(), predicted.y() - sight.pixel.y()};
  }
};

}  // namespace kinecal
