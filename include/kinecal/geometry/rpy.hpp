// Roll, pitch, yaw, as in a URDF: R = Rz(yaw) Ry(pitch) Rx(roll).
//
// Only files and reports use them; everything else uses matrices and rotation vectors.
// Source: URDF specification, <origin rpy>: fixed-axis rotations about x, then y, then z.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// Rotation matrix from roll, pitch, yaw.
/// @param rpy  (3) roll, pitch, yaw, radians
[[nodiscard]] inline Matrix3<double> rotation_from_rpy(const Vector3<double>& rpy) {
  const double cr = std::cos(rpy.x()), sr = std::sin(rpy.x());
  const double cp = std::cos(rpy.y()), sp = std::sin(rpy.y());
  const double cy = std::cos(rpy.z()), sy = std::sin(rpy.z());
  Matrix3<double> r;
  r << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return r;
}

/// Roll, pitch, yaw of a rotation matrix.
/// @returns  (3) roll, pitch, yaw, radians; pitch in [-pi/2, pi/2].  At pitch = +-pi/2 the matrix
///           determines only yaw -+ roll; roll is then zero.
[[nodiscard]] inline Vector3<double> rpy_from_rotation(const Matrix3<double>& r) {
  const double cos_pitch = std::hypot(r(0, 0), r(1, 0));
  const double pitch = std::atan2(-r(2, 0), cos_pitch);
  // Below this cosine, rounding errors swamp yaw and roll.
  constexpr double kGimbalLock = 1e-12;
  if (cos_pitch < kGimbalLock) return {0.0, pitch, std::atan2(-r(0, 1), r(1, 1))};
  // Take yaw out first, then compute roll from entries of size one: accurate near gimbal lock.
  const double yaw = std::atan2(r(1, 0), r(0, 0));
  const double cy = std::cos(yaw), sy = std::sin(yaw);
  const double roll = std::atan2(sy * r(0, 2) - cy * r(1, 2), cy * r(1, 1) - sy * r(0, 1));
  return {roll, pitch, yaw};
}

}  // namespace kinecal
