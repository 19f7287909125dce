// Two sensors observe the same plane (plane_to_plane).
//
//   r = ( (n_a - n_b) normal_scale,  n_b . (c_a - c_b) offset_scale )
//
// with normals n and centroids c of the two sets of points.  n_b is flipped to the side of n_a, so
// the sign does not jump when a plane passes through the origin.
// Source: Fetch paper, III-B.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Difference of two planes.
struct PlaneToPlane {
  static constexpr const char* kType = "plane_to_plane";  ///< name in configurations
  static constexpr const char* kUnit = "1";               ///< of the residual

  double normal_scale = 1.0;  ///< factor of the difference of normals
  double offset_scale = 1.0;  ///< 1 / metre

  /// The difference of two planes in the base.
  /// @returns  (4) scaled: difference of the normals (3), distance of centroid a to plane b (1)
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 4, 1> operator()(const Plane<S>& a, const Plane<S>& b) const {
    const S side = a.normal.dot(b.normal) < S(0.0) ? S(-1.0) : S(1.0);
    const Vector3<S> n_b = b.normal * side;
    Eigen::Matrix<S, 4, 1> r;
    r << (a.normal - n_b) * S(normal_scale), n_b.dot(a.centroid - b.centroid) * S(offset_scale);
    return r;
  }
};

}  // namespace kinecal
