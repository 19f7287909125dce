// A depth camera (camera3d): re-projects points with corrected intrinsics and depth.
//
// The driver computed a recorded point (x, y, z) from a pixel and a raw depth, with its settings at
// that time.  We recover pixel and raw depth, and compute the point with the corrected settings:
//
//   u = fx0 x / z + cx0      v = fy0 y / z + cy0      z0 = z / s0 - o0
//   z1 = (z0 + z_offset) (1 + z_scaling)            z' = z1 g: depth_polynomial.hpp
//   x' = (u - cx0 (1 + cx)) z' / (fx0 (1 + fx))      y' likewise
//
// Parameters, in this order: fx fy cx cy (relative), z_offset (metres), z_scaling (relative), and those of the
// polynomial g: z_quadratic (1/m), z_x z_y z_xx z_xy z_yy (relative).  With these at zero, g is exactly 1.
// Defined for z > 0.
// Source: Fetch paper, III-B; the camera driver defines z1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/depth/corrected_depth_camera.hpp"
#include "kinecal/sensors/depth/depth_polynomial.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// A depth camera.
struct DepthCamera {
  static constexpr std::string_view kType = "camera3d";  ///< name in configurations
  static constexpr std::size_t kWithoutPolynomial = 6;   ///< fx fy cx cy z_offset z_scaling
  /// These, and the coefficients of the polynomial.
  static constexpr std::array kParameters = {ParameterInfo{"fx"},
                                             ParameterInfo{"fy"},
                                             ParameterInfo{"cx"},
                                             ParameterInfo{"cy"},
                                             ParameterInfo{"z_offset", "m"},
                                             ParameterInfo{"z_scaling"},
                                             kDepthPolynomial[0],
                                             kDepthPolynomial[1],
                                             kDepthPolynomial[2],
                                             kDepthPolynomial[3],
                                             kDepthPolynomial[4],
                                             kDepthPolynomial[5]};
  using Values = std::array<double, kWithoutPolynomial + kDepthTerms>;  ///< of its parameters
  static constexpr std::size_t kSettings = 6;  ///< fx fy cx cy z_offset z_scaling, as recorded
  static constexpr bool kOwnFrame = true;      ///< features are in the optical frame
  /// Computes points and derivatives; shares work between the points of a sample.
  template <class Q>
  using Corrected = CorrectedDepthCamera<Q>;

  /// The recorded settings: of the rectified image, from P; from K if P is zero.
  /// @throws SettingsError  if they are missing or they are impossible
  [[nodiscard]] static std::array<double, 6> settings(const Observation& seen) {
    const CameraInfo& info = camera_info_of(seen);
    std::array<double, 6> s = {info.p[0], info.p[5],     info.p[2],
                               info.p[6], info.z_offset, info.z_scaling};
    if (s[0] == 0.0 && s[1] == 0.0) {
      s = {info.k[0], info.k[4], info.k[2], info.k[5], info.z_offset, info.z_scaling};
    }
    check_camera_settings(s);
    if (!(s[5] > 0.0)) throw SettingsError("z_scaling is not positive");
    return s;
  }
  /// Its camera_info with corrected intrinsics.
  /// @param v  (12) parameters in the order above
  [[nodiscard]] static CameraInfo calibrated(const CameraInfo& info, const Values& v) {
    return calibrated_camera_info(info, v[0], v[1], v[2], v[3]);
  }
  /// Parameters with which a recorded point stays where it is.
  [[nodiscard]] static Values initial(const std::array<double, 6>& s) {
    return {0.0, 0.0, 0.0, 0.0, s[4], s[5] - 1.0};
  }
  /// The pixel and raw depth from which the driver computed a point.
  /// @param p  (3) recorded point, metres, in the camera's optical frame
  /// @param s  settings
  /// @returns  (3) u, v, z0; pixels and metres
  /// @throws SettingsError  if the point is behind the camera
  [[nodiscard]] static Vector3<double> measurement(const Vector3<double>& p,
                                                   const std::array<double, 6>& s) {
    if (!(p.z() > 0.0)) {
      throw SettingsError("a point is behind the camera (z = " + std::to_string(p.z()) + " m)");
    }
    return {s[0] * p.x() / p.z() + s[2], s[1] * p.y() / p.z() + s[3], p.z() / s[5] - s[4]};
  }

  /// The point of a measurement with corrected settings.
  /// @param v  (12) parameters in the order above; or (6), without the polynomial
  /// @returns  (3) metres, in the camera's optical frame
  template <class S, class Q, std::size_t N>
  requires(N == kWithoutPolynomial || N == kWithoutPolynomial + kDepthTerms)
      [[nodiscard]] Vector3<S> place(const Measurement<DepthCamera, Q>& m,
                                     const std::array<S, N>& v) const {
    const auto& s = m.settings;
    S z = (m.point.z() + v[4]) * (1.0 + v[5]);
    if constexpr (N > kWithoutPolynomial) {
      const Q x = (m.point.x() - s[2]) / s[0], y = (m.point.y() - s[3]) / s[1];
      z = z * depth_factor(z, x, y, std::span(v).template subspan<kWithoutPolynomial>());
    }
    return {(m.point.x() - s[2] * (1.0 + v[2])) * z / (s[0] * (1.0 + v[0])),
            (m.point.y() - s[3] * (1.0 + v[3])) * z / (s[1] * (1.0 + v[1])), z};
  }
};
static_assert(Sensor<DepthCamera>);

}  // namespace kinecal
