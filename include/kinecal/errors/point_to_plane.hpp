// Distance of a point to a known plane (chain3d_to_plane).  r = (n . p + d) / |n|
//
// The distance is signed: the cost is the same as with an absolute value, which would have a kink
// exactly at the solution.
// Source: Fetch paper, III-B, the ground plane.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to a known plane.
class PointToPlane {
 public:
  static constexpr const char* kType = "chain3d_to_plane";  ///< name in configurations
  static constexpr const char* kUnit = "m";                 ///< of the residual

  /// The floor: z = 0.
  PointToPlane() : PointToPlane(0.0, 0.0, 1.0, 0.0) {}
  /// The plane a x + b y + c z + d = 0 in the base, metres.
  /// @throws std::invalid_argument  if (a, b, c) is zero
  PointToPlane(double a, double b, double c, double d) : normal_(a, b, c), d_(d) {
    const double length = normal_.stableNorm();
    if (!(length > 0.0))
      throw std::invalid_argument("the plane's normal (a, b, c) has length zero");
    normal_ /= length;
    d_ /= length;
  }

  /// The distance of a point.
  /// @param p_base  (3) feature, metres, in the base
  /// @returns       (1) signed distance, metres
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base) const {
    return Eigen::Matrix<S, 1, 1>(normal_.x() * p_base.x() + normal_.y() * p_base.y() +
                                  normal_.z() * p_base.z() + d_);
  }

 private:
  Vector3<double> normal_;
  double d_;
};

}  // namespace kinecal
