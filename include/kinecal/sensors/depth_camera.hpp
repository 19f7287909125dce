// A depth camera (camera3d): re-projects points with corrected intrinsics and depth.
//
// The driver computed a recorded point (x, y, z) from a pixel and a raw depth, with its settings at
// that time.  We recover pixel and raw depth, and compute the point with the corrected settings:
//
//   u = fx0 x / z + cx0      v = fy0 y / z + cy0      z0 = z / s0 - o0
//   z' = (z0 + z_offset) (1 + z_scaling)
//   x' = (u - cx0 (1 + cx)) z' / (fx0 (1 + fx))      y' likewise
//
// Parameters, in this order: fx fy cx cy (relative), z_offset (metres), z_scaling (relative).
// Defined for z > 0.
// Source: Fetch paper, III-B; the camera driver defines the depth correction.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>

#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

template <class Q>
class CorrectedDepthCamera;

/// A depth camera.
struct DepthCamera {
  static constexpr std::string_view kType = "camera3d";  ///< name in configurations
  static constexpr std::array kParameters = {ParameterInfo{"fx"},
                                             ParameterInfo{"fy"},
                                             ParameterInfo{"cx"},
                                             ParameterInfo{"cy"},
                                             ParameterInfo{"z_offset", "m"},
                                             ParameterInfo{"z_scaling"}};
  static constexpr std::size_t kSettings = 6;  ///< fx fy cx cy z_offset z_scaling, as recorded
  static constexpr bool kOwnFrame = true;      ///< features are in the optical frame
  /// Computes points and derivatives; shares work between the points of a sample.
  template <class Q>
  using Corrected = CorrectedDepthCamera<Q>;

  /// The recorded settings: of the rectified image, from P; from K if P is zero.
  /// @throws SettingsError  if there are none or they are impossible
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
  /// @param v  (6) parameters in the order above
  [[nodiscard]] static CameraInfo calibrated(const CameraInfo& info,
                                             const std::array<double, 6>& v) {
    return calibrated_camera_info(info, v[0], v[1], v[2], v[3]);
  }
  /// Parameters with which a recorded point stays where it is.
  [[nodiscard]] static std::array<double, 6> initial(const std::array<double, 6>& s) {
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
  /// @param v  (6) parameters in the order above
  /// @returns  (3) metres, in the camera's optical frame
  template <class S, class Q>
  [[nodiscard]] Vector3<S> place(const Measurement<DepthCamera, Q>& m,
                                 const std::array<S, 6>& v) const {
    const auto& s = m.settings;
    const S z = (m.point.z() + v[4]) * (1.0 + v[5]);
    return {(m.point.x() - s[2] * (1.0 + v[2])) * z / (s[0] * (1.0 + v[0])),
            (m.point.y() - s[3] * (1.0 + v[3])) * z / (s[1] * (1.0 + v[1])), z};
  }
};

/// A depth camera with corrected settings at a pose; computes once what all points of a sample
/// share.  Focal lengths and principal point move a point in x or y only; offset and scaling move it
/// along its ray.
template <class Q>
class CorrectedDepthCamera {
 public:
  /// @param pose      of the camera in the base; must outlive this
  /// @param recorded  fx fy cx cy z_offset z_scaling: DepthCamera::settings()
  /// @param v         (6) parameters: corrections of the recorded settings
  CorrectedDepthCamera(const Pose<Q>& pose, const std::array<Q, 6>& recorded,
                       std::span<const double> v)
      : pose_(pose),
        per_fx_(Q(1.0) / (recorded[0] * Q(1.0 + v[0]))),
        per_fy_(Q(1.0) / (recorded[1] * Q(1.0 + v[1]))),
        cx_(recorded[2] * Q(1.0 + v[2])),
        cy_(recorded[3] * Q(1.0 + v[3])),
        s_by_cx_(-(recorded[2] * per_fx_)),
        t_by_cy_(-(recorded[3] * per_fy_)),
        by_fx_(-(recorded[0] * per_fx_)),
        by_fy_(-(recorded[1] * per_fy_)),
        offset_(v[4]),
        factor_(1.0 + v[5]) {}

  /// The point of a measurement and its derivatives.
  /// @param m        (3) pixel and raw depth: DepthCamera::measurement()
  /// @param chosen   which parameters to differentiate by, ascending
  /// @param changes  out, for each of them: (3) metres per unit, in the base
  /// @returns        (3) metres, in the base
  Vector3<Q> place(const Vector3<Q>& m, std::span<const int> chosen, Vector3<Q>* changes) const {
    const Matrix3<Q>& r = pose_.rotation;
    const Q s = (m.x() - cx_) * per_fx_, t = (m.y() - cy_) * per_fy_;
    const Q raw = m.z() + offset_, depth = raw * factor_;
    const Vector3<Q> ray(r(0, 0) * s + r(0, 1) * t + r(0, 2), r(1, 0) * s + r(1, 1) * t + r(1, 2),
                         r(2, 0) * s + r(2, 1) * t + r(2, 2));
    const auto times = [](const auto& v, const Q& x) {
      return Vector3<Q>(v(0) * x, v(1) * x, v(2) * x);
    };
    Vector3<Q> p;
    for (int i = 0; i < 3; ++i) p(i) = pose_.translation(i) + ray(i) * depth;
    if (chosen.size() == 6) {  // the usual case: all of them, in order
      changes[0] = times(r.col(0), s * depth * by_fx_);
      changes[1] = times(r.col(1), t * depth * by_fy_);
      changes[2] = times(r.col(0), s_by_cx_ * depth);
      changes[3] = times(r.col(1), t_by_cy_ * depth);
      changes[4] = times(ray, factor_);
      changes[5] = times(ray, raw);
      return p;
    }
    for (const int k : chosen) {
      switch (k) {
        case 0:
          *changes++ = times(r.col(0), s * depth * by_fx_);
          break;
        case 1:
          *changes++ = times(r.col(1), t * depth * by_fy_);
          break;
        case 2:
          *changes++ = times(r.col(0), s_by_cx_ * depth);
          break;
        case 3:
          *changes++ = times(r.col(1), t_by_cy_ * depth);
          break;
        case 4:
          *changes++ = times(ray, factor_);
          break;
        default:
          *changes++ = times(ray, raw);
      }
    }
    return p;
  }

 private:
  const Pose<Q>& pose_;
  Q per_fx_, per_fy_, cx_, cy_, s_by_cx_, t_by_cy_, by_fx_, by_fy_, offset_, factor_;
};

}  // namespace kinecal
