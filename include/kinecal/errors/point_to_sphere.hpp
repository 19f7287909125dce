// A point on a sphere (point_to_sphere): the end of a bar whose other end turns in a socket, or the
// surface of a ball.
//
//   r = |p - center| - radius
//
// Center and radius are parameters of the block, <block>_x _y _z _radius: free them if unknown.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to a sphere.
struct PointToSphere {
  static constexpr const char* kType = "point_to_sphere";  ///< name in configurations
  static constexpr const char* kUnit = "m";                ///< of the residual
  static constexpr std::array kParameters = {ParameterInfo{"x", "m"}, ParameterInfo{"y", "m"},
                                             ParameterInfo{"z", "m"},
                                             ParameterInfo{"radius", "m", 0.0, 0.0}};

  Vector3<double> center = Vector3<double>::Zero();  ///< (3) metres, in the base
  double radius = 0.0;                               ///< metres

  /// Initial values of the parameters.
  [[nodiscard]] std::array<double, 4> initial() const {
    return {center.x(), center.y(), center.z(), radius};
  }

  /// The distance of a point.
  /// @param p_base  (3) metres, in the base
  /// @param own     (4) center and radius, metres
  /// @returns       (1) metres, positive outside
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base,
                                                  const std::array<S, 4>& own) const {
    using std::sqrt;
    const S x = p_base.x() - own[0], y = p_base.y() - own[1], z = p_base.z() - own[2];
    return Eigen::Matrix<S, 1, 1>(sqrt(x * x + y * y + z * z) - own[3]);
  }
};

}  // namespace kinecal
