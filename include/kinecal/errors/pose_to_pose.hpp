// Two sensors observe the pose of the same body (pose_to_pose).
//
//   r = ( (t_a - t_b) translation_scale,  log(R_b^T R_a) rotation_scale )
//
// Defined for rotations by less than 180 degrees.
// Source: Park, Martin, Robot sensor calibration: solving AX = XB on the Euclidean group, 1994.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/errors/error_block.hpp"

namespace kinecal {

/// Difference of two poses: of a marker, or of a body tracked by motion capture.
struct PoseToPose {
  static constexpr const char* kType = "pose_to_pose";  ///< name in configurations
  static constexpr const char* kUnit = "1";             ///< of the residual

  double translation_scale = 1.0;  ///< 1 / metre: one over the standard deviation of a position
  double rotation_scale = 1.0;     ///< 1 / radian: one over the standard deviation of a rotation

  /// The difference of two poses in the base.
  /// @returns  (6) scaled: translation (3), rotation vector in the frame of b (3)
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 6, 1> operator()(const Pose<S>& a, const Pose<S>& b) const {
    using std::atan2, std::sqrt;
    const Matrix3<S>&p = a.rotation, &q = b.rotation;
    const auto entry = [&](int row, int column) {  // of R_b^T R_a
      return q(0, row) * p(0, column) + q(1, row) * p(1, column) + q(2, row) * p(2, column);
    };
    const Vector3<S> sine(0.5 * (entry(2, 1) - entry(1, 2)), 0.5 * (entry(0, 2) - entry(2, 0)),
                          0.5 * (entry(1, 0) - entry(0, 1)));
    const S cosine = 0.5 * (entry(0, 0) + entry(1, 1) + entry(2, 2) - 1.0);
    const S s2 = sine.x() * sine.x() + sine.y() * sine.y() + sine.z() * sine.z();
    const auto small = s2 < S(1e-6);
    const S root = sqrt(select(small, S(1.0), s2));
    // asin(s) / s by its series near zero
    const S series = 1.0 + s2 * (1.0 / 6.0 + s2 * (3.0 / 40.0 + s2 * (15.0 / 336.0)));
    const S factor = select(small, series, S(atan2(root, cosine) / root)) * rotation_scale;
    Eigen::Matrix<S, 6, 1> r;
    for (int k = 0; k < 3; ++k) {
      r(k) = (a.translation(k) - b.translation(k)) * translation_scale;
      r(3 + k) = sine(k) * factor;
    }
    return r;
  }
};
static_assert(ScaledPoseBlock<PoseToPose>);

}  // namespace kinecal
