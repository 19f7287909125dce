// A point lies on the z axis of a pose (point_on_line): a tip that touches an edge or a wire, wherever it is.
//
//   r = ( x axis of R . (p - t),  y axis of R . (p - t) )
//
// The pose (R, t) is a feature of a chain6d sensor.  Its shift along z and its rotation about z change nothing: free
// x, y, roll and pitch of its frame.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to the z axis of a pose, in two directions.
struct PointOnLine {
  using Inputs = Takes<Quantity::point, Quantity::pose>;  ///< what touches, what is touched
  static constexpr const char* kType = "point_on_line";   ///< name in configurations
  static constexpr const char* kUnit = "m";               ///< of the residual

  /// The distance.
  /// @param p     (3) metres, in the base
  /// @param line  its z axis
  /// @returns     (2) metres, along x and y of the pose
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> operator()(const Vector3<S>& p, const Pose<S>& line) const {
    const Matrix3<S>& r = line.rotation;
    const S x = p.x() - line.translation.x(), y = p.y() - line.translation.y(),
            z = p.z() - line.translation.z();
    return {r(0, 0) * x + r(1, 0) * y + r(2, 0) * z, r(0, 1) * x + r(1, 1) * y + r(2, 1) * z};
  }
};

}  // namespace kinecal
