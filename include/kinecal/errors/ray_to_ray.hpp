// Two cameras see the same point at an unknown position (camera2d_to_camera2d).
//
//   r = e / |de/d(pixels)|      e = (o_b - o_a) . (d_a x d_b)
//
// with origins o and directions d of the lines of sight: the distance, in pixels and to first
// order, that the observed pixels must move for the lines to meet (Sampson's distance).  One
// residual: moving the point along the lines costs nothing.  So samples determine the relative
// poses of the cameras, but not the scale.
// Source: Hartley and Zisserman, Multiple View Geometry, 11.4.3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of two lines of sight, in pixels.
struct RayToRay {
  static constexpr const char* kType = "camera2d_to_camera2d";  ///< name in configurations
  static constexpr const char* kUnit = "px";                    ///< of the residual

  /// The distance of two lines of sight.
  /// @returns  (1) pixels
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Ray<S>& a, const Ray<S>& b) const {
    using std::sqrt;
    const Vector3<S> way = b.origin - a.origin;
    const Vector3<S> by_a = cross(b.direction, way), by_b = cross(way, a.direction);
    const auto dot = [](const Vector3<S>& u, const Vector3<S>& v) {
      return S(u.x() * v.x() + u.y() * v.y() + u.z() * v.z());
    };
    const S g[] = {dot(by_a, a.by_u), dot(by_a, a.by_v), dot(by_b, b.by_u), dot(by_b, b.by_v)};
    const S length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] + g[3] * g[3]);
    return Eigen::Matrix<S, 1, 1>(dot(by_a, a.direction) / length);
  }
};

}  // namespace kinecal
