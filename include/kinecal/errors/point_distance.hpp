// Two points at a constant distance (point_distance): the ends of a bar.
//
//   r = |p_a - p_b| - length
//
// The length is a parameter of the block, <block>_length: free it if it is unknown.
// Source: Hollerbach and Wampler, The calibration index and taxonomy for robot kinematic
// calibration methods, 1996 (ball bars).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of two points, less the length of the bar between them.
struct PointDistance {
  static constexpr const char* kType = "point_distance";  ///< name in configurations
  static constexpr const char* kUnit = "m";               ///< of the residual
  static constexpr std::array kParameters = {ParameterInfo{"length", "m", 0.0, 0.0}};

  double length = 0.0;  ///< metres

  /// Initial values of the parameters.
  [[nodiscard]] std::array<double, 1> initial() const { return {length}; }

  /// The error of the distance.
  /// @param p_a, p_b  (3) points of two sensors, metres, in the base
  /// @param own       (1) length, metres
  /// @returns         (1) metres
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_a, const Vector3<S>& p_b,
                                                  const std::array<S, 1>& own) const {
    using std::sqrt;
    const Vector3<S> d = p_a - p_b;
    const S distance = sqrt(d.x() * d.x() + d.y() * d.y() + d.z() * d.z());
    return Eigen::Matrix<S, 1, 1>(distance - own[0]);
  }
};

}  // namespace kinecal
