// Definitions of image.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/image.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

namespace kinecal {

PointCloud points_of(const DepthImage& depth, const CameraInfo& camera) {
  const auto &fx = camera.p[0], &fy = camera.p[5], &cx = camera.p[2], &cy = camera.p[6];
  if (!(fx > 0.0) || !(fy > 0.0)) {
    throw std::invalid_argument("focal lengths of a depth camera must be positive, are " +
                                std::to_string(fx) + " and " + std::to_string(fy));
  }
  if (depth.width != camera.width || depth.height != camera.height) {
    throw std::invalid_argument("a depth image has " + std::to_string(depth.width) + " x " +
                                std::to_string(depth.height) + " pixels, its camera_info says " +
                                std::to_string(camera.width) + " x " +
                                std::to_string(camera.height));
  }
  PointCloud points(depth.width, depth.height, no_point());
  for (int v = 0; v < depth.height; ++v) {
    const double y = (v - cy) / fy;
    for (int u = 0; u < depth.width; ++u) {
      const float z = depth(u, v);
      if (!(z > 0.0F) || !std::isfinite(z)) continue;
      const double x = (u - cx) / fx;
      points(u, v) = Vector3<double>(x * z, y * z, z).cast<float>();
    }
  }
  return points;
}

}  // namespace kinecal
