// A depth camera (camera3d): points re-projected with corrected intrinsics and depth.
//
// The driver computed a recorded point (x, y, z) from a pixel and a raw depth, with the settings of
// that moment.  We recover pixel and raw depth, and compute the point with the corrected settings:
//
//   u = fx0 x / z + cx0      v = fy0 y / z + cy0      z0 = z / s0 - o0
//   z' = (z0 + z_offset) (1 + z_scaling)
//   x' = (u - cx0 (1 + cx)) z' / (fx0 (1 + fx))      y' likewise
//
// Parameters, in this order: fx fy cx cy (relative), z_offset (metres), z_scaling (relative).
// Defined for z > 0.
// Source: Fetch paper, III-B; the depth correction is that of the camera driver.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A depth camera as it was recorded.
template <class Q = double>
struct DepthCamera {
  static constexpr int kParameters = 6;  ///< fx fy cx cy z_offset z_scaling

  Q fx;              ///< recorded focal length, pixels
  Q fy;              ///< recorded focal length, pixels
  Q cx;              ///< recorded principal point, pixels
  Q cy;              ///< recorded principal point, pixels
  Q z_offset{0.0};   ///< recorded depth offset, metres
  Q z_scaling{1.0};  ///< recorded depth scale, a factor

  /// The camera of a rectified image, from P.
  [[nodiscard]] static DepthCamera from(const CameraInfo& info) {
    return {info.p[0], info.p[5], info.p[2], info.p[6], info.z_offset, info.z_scaling};
  }

  /// The pixel and raw depth from which the driver computed a point.
  /// @param p  (3) recorded point, metres, in the camera's optical frame
  /// @returns  (3) u, v, z0; pixels and metres
  [[nodiscard]] Vector3<Q> measurement(const Vector3<Q>& p) const {
    return {fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy, p.z() / z_scaling - z_offset};
  }

  /// The point of a measurement with corrected settings.
  /// @param m  (3) pixel and raw depth: measurement()
  /// @param v  (6) parameters in the order above
  /// @returns  (3) metres, in the camera's optical frame
  template <class S>
  [[nodiscard]] Vector3<S> point(const Vector3<Q>& m, const std::array<S, 6>& v) const {
    const S z = (m.z() + v[4]) * (1.0 + v[5]);
    return {(m.x() - cx * (1.0 + v[2])) * z / (fx * (1.0 + v[0])),
            (m.y() - cy * (1.0 + v[3])) * z / (fy * (1.0 + v[1])), z};
  }
};

/// A depth camera with corrected settings; what all points of a sample share is computed once.
template <class Q>
class CorrectedDepthCamera {
 public:
  /// A point depth (s, t, 1) in the optical frame and its derivatives.  Focal lengths and principal
  /// point move x or y only; offset and scaling change the depth only.
  struct Seen {
    Q s;                 ///< x / depth
    Q t;                 ///< y / depth
    Q depth;             ///< z, metres
    Q x_by_fx;           ///< dx / dfx, metres
    Q y_by_fy;           ///< dy / dfy, metres
    Q x_by_cx;           ///< dx / dcx, metres
    Q y_by_cy;           ///< dy / dcy, metres
    Q depth_by_offset;   ///< ddepth / dz_offset
    Q depth_by_scaling;  ///< ddepth / dz_scaling, metres
  };

  /// @param v  (6) fx fy cx cy z_offset z_scaling: corrections of the recorded settings
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

  /// The point of a measurement.
  /// @param m  (3) pixel and raw depth: DepthCamera::measurement()
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
