// A point lies on the plane z = 0 of a pose (point_on_plane): a tip that touches a table, wherever it stands.
//
//   r = z axis of R . (p - t)
//
// The pose (R, t) is a feature of a chain6d sensor.  Its shift along x and y and its rotation about z change nothing:
// free z, roll and pitch of its frame.
// Source: Zhuang, Motaghedi, Roth, Robot calibration with planar constraints, 1999.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Distance of a point to the plane z = 0 of a pose.
struct PointOnPlane {
  using Inputs = Takes<Quantity::point, Quantity::pose>;  ///< what touches, what is touched
  static constexpr const char* kType = "point_on_plane";  ///< name in configurations
  static constexpr const char* kUnit = "m";               ///< of the residual

  /// The distance.
  /// @param p      (3) metres, in the base
  /// @param plane  its z axis is the normal
  /// @returns      (1) metres, positive on the side to which z points
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p, const Pose<S>& plane) const {
    const Matrix3<S>& r = plane.rotation;
    const Vector3<S>& t = plane.translation;
    return Eigen::Matrix<S, 1, 1>(r(0, 2) * (p.x() - t.x()) + r(1, 2) * (p.y() - t.y()) +
                                  r(2, 2) * (p.z() - t.z()));
  }
};

}  // namespace kinecal
