// A pinhole camera (camera2d): where a point appears in the image.
//
//   x = X / Z,  y = Y / Z,  r2 = x^2 + y^2
//   x' = x (1 + k1 r2 + k2 r2^2 + k3 r2^3) + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y (1 + k1 r2 + k2 r2^2 + k3 r2^3) + p1 (r2 + 2 y^2) + 2 p2 x y
//   u = fx0 (1 + fx) x' + cx0 (1 + cx)      v = fy0 (1 + fy) y' + cy0 (1 + cy)
//
// Parameters, in this order: fx fy cx cy (relative).  The distortion (plumb_bob: k1 k2 p1 p2 k3) is
// not calibrated.  Defined for Z > 0.
// Source: sensor_msgs/CameraInfo; Brown, Decentering Distortion of Lenses, 1966.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>

#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// A pinhole camera as it was recorded.
template <class Q = double>
struct PinholeCamera {
  static constexpr int kParameters = 4;  ///< fx fy cx cy

  Q fx;                     ///< focal length, pixels
  Q fy;                     ///< focal length, pixels
  Q cx;                     ///< principal point, pixels
  Q cy;                     ///< principal point, pixels
  std::array<Q, 5> d = {};  ///< distortion: k1 k2 p1 p2 k3

  /// The camera of a CameraInfo: from K and D if the image is distorted, else from P.
  [[nodiscard]] static PinholeCamera from(const CameraInfo& info) {
    const bool distorted =
        std::any_of(info.d.begin(), info.d.end(), [](double v) { return v != 0.0; });
    if (!distorted) return {info.p[0], info.p[5], info.p[2], info.p[6], {}};
    PinholeCamera camera{info.k[0], info.k[4], info.k[2], info.k[5], {}};
    std::copy_n(info.d.begin(), std::min<std::size_t>(info.d.size(), 5), camera.d.begin());
    return camera;
  }

  /// The pixel at which a point appears.
  /// @param p  (3) point, metres, in the camera's optical frame
  /// @param v  (4) fx fy cx cy: relative corrections of the recorded intrinsics
  /// @returns  (2) pixel
  template <class S>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> project(const Vector3<S>& p,
                                               const std::array<S, 4>& v) const {
    const S x = p.x() / p.z(), y = p.y() / p.z();
    const S xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy;
    const S radial = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    const S u = x * radial + 2.0 * (d[2] * xy) + d[3] * (r2 + 2.0 * xx);
    const S w = y * radial + d[2] * (r2 + 2.0 * yy) + 2.0 * (d[3] * xy);
    return {fx * (1.0 + v[0]) * u + cx * (1.0 + v[2]), fy * (1.0 + v[1]) * w + cy * (1.0 + v[3])};
  }
};

}  // namespace kinecal
