// Distance of a point to the camera's line of sight.
//
//   r = d x (p - o) / |d|
//
// with origin o and direction d of the line of sight.  It has no meaning in the image, but it is
// defined everywhere, even behind the camera, and linear in the point.  From a poor start it leads
// to the pose that pixels then refine; solve/starts.hpp uses it for that.
// Source: Lu, Hager, Mjolsness, Fast and Globally Convergent Pose Estimation from Video Images,
// 2000.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to a line of sight.
struct PointToRay {
  static constexpr const char* kType = "point_to_ray";   ///< for reports
  static constexpr const char* kUnit = "m";              ///< of the residual
  using Inputs = Takes<Quantity::point, Quantity::ray>;  ///< of its sensors, in this order

  /// The distance of a point to a line of sight.
  /// @param p_base  (3) metres, in the base
  /// @param ray     in the base
  /// @returns       (3) metres, perpendicular to both
  template <class S>
  [[nodiscard]] Vector3<S> operator()(const Vector3<S>& p_base, const Ray<S>& ray) const {
    using std::sqrt;
    const Vector3<S>& d = ray.direction;
    const Vector3<S> way = p_base - ray.origin;
    const S inverse = 1.0 / sqrt(S(d.x() * d.x() + d.y() * d.y() + d.z() * d.z()));
    const Vector3<S> across = cross(d, way);
    return {across.x() * inverse, across.y() * inverse, across.z() * inverse};
  }
};

}  // namespace kinecal
