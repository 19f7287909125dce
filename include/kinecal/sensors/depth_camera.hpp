// A depth camera (camera3d): points re-projected with corrected intrinsics and depth.
//
// A recorded point (x, y, z) was made from a pixel and a raw depth by the settings of that moment.
// Both are found again, then turned into a point with the corrected settings:
//
//   u = fx0 x / z + cx0      v = fy0 y / z + cy0      z0 = z / s0 - o0
//   z' = (z0 + z_offset) (1 + z_scaling)
//   x' = (u - cx0 (1 + cx)) z' / (fx0 (1 + fx))      y' likewise
//
// Parameters, in this order: fx fy cx cy (relative), z_offset (metres), z_scaling (relative).
// Defined for z > 0.  Source: Fetch paper, III-B; the depth correction is that of the camera
// driver. SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

struct DepthCamera {
  static constexpr int kParameters = 6;

  double fx, fy, cx, cy;                   ///< recorded intrinsics, pixels
  double z_offset = 0.0, z_scaling = 1.0;  ///< recorded depth correction, metres and factor

  [[nodiscard]] static DepthCamera from(const CameraInfo& info) {
    return {info.p[0], info.p[5], info.p[2], info.p[6], info.z_offset, info.z_scaling};
  }

  /// The pixel and raw depth (u, v, z0) from which a point was recorded; pixels and metres.
  /// @param p  (3) recorded point, metres, in the camera's optical frame
  [[nodiscard]] Vector3<double> measurement(const Vector3<double>& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, p.z() / z_scaling - z_offset};
  }

  /// The point that a measurement means under corrected settings.
  /// @param m  (3) pixel and raw depth
  /// @param v  (6) parameters in the order above
  /// @returns  (3) metres, in the camera's optical frame
  template <class S>
  [[nodiscard]] Vector3<S> point(const Vector3<double>& m, const std::array<S, 6>& v) const {
    const S z = (m.z() + v[4]) * (1.0 + v[5]);
    return {(m.x() - cx * (1.0 + v[2])) * z / (fx * (1.0 + v[0])),
            (m.y() - cy * (1.0 + v[3])) * z / (fy * (1.0 + v[1])), z};
  }
};

}  // namespace kinecal
