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
// driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

template <class Q = double>
struct DepthCamera {
  static constexpr int kParameters = 6;

  Q fx, fy, cx, cy;                 ///< recorded intrinsics, pixels
  Q z_offset{0.0}, z_scaling{1.0};  ///< recorded depth correction, metres and factor

  [[nodiscard]] static DepthCamera from(const CameraInfo& info) {
    return {info.p[0], info.p[5], info.p[2], info.p[6], info.z_offset, info.z_scaling};
  }

  /// The pixel and raw depth (u, v, z0) from which a point was recorded; pixels and metres.
  /// @param p  (3) recorded point, metres, in the camera's optical frame
  [[nodiscard]] Vector3<Q> measurement(const Vector3<Q>& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, p.z() / z_scaling - z_offset};
  }

  /// The point that a measurement means under corrected settings.
  /// @param m  (3) pixel and raw depth
  /// @param v  (6) parameters in the order above
  /// @returns  (3) metres, in the camera's optical frame
  template <class S>
  [[nodiscard]] Vector3<S> point(const Vector3<Q>& m, const std::array<S, 6>& v) const {
    const S z = (m.z() + v[4]) * (1.0 + v[5]);
    return {(m.x() - cx * (1.0 + v[2])) * z / (fx * (1.0 + v[0])),
            (m.y() - cy * (1.0 + v[3])) * z / (fy * (1.0 + v[1])), z};
  }
};

/// A depth camera under corrected settings: what is the same for all points of a sample is found
/// once.
template <class Q>
class CorrectedDepthCamera {
 public:
  /// A point depth (s, t, 1) in the optical frame and how the parameters change it: focal lengths
  /// and center move x or y alone, offset and scaling change the depth alone.
  struct Seen {
    Q s, t, depth;
    Q x_by_fx, y_by_fy, x_by_cx, y_by_cy;
    Q depth_by_offset, depth_by_scaling;
  };

  /// @param v  (6) parameters in the order above
  CorrectedDepthCamera(const DepthCamera<Q>& recorded, const std::array<double, 6>& v)
      : per_fx_(Q(1.0) / (recorded.fx * Q(1.0 + v[0]))),
        per_fy_(Q(1.0) / (recorded.fy * Q(1.0 + v[1]))),
        cx_(recorded.cx * Q(1.0 + v[2])),
        cy_(recorded.cy * Q(1.0 + v[3])),
        s_by_cx_(-(recorded.cx * per_fx_)),
        t_by_cy_(-(recorded.cy * per_fy_)),
        by_fx_(-(recorded.fx * per_fx_)),
        by_fy_(-(recorded.fy * per_fy_)),
        offset_(v[4]),
        factor_(1.0 + v[5]) {}

  /// @param m  (3) pixel and raw depth
  [[nodiscard]] Seen see(const Vector3<Q>& m) const {
    const Q s = (m.x() - cx_) * per_fx_, t = (m.y() - cy_) * per_fy_;
    const Q raw = m.z() + offset_, depth = raw * factor_;
    return {s,
            t,
            depth,
            s * depth * by_fx_,
            t * depth * by_fy_,
            s_by_cx_ * depth,
            t_by_cy_ * depth,
            factor_,
            raw};
  }

 private:
  Q per_fx_, per_fy_, cx_, cy_, s_by_cx_, t_by_cy_, by_fx_, by_fy_, offset_, factor_;
};

}  // namespace kinecal
