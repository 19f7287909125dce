// A pinhole camera (camera2d): projects a point to a pixel, and a pixel to its ray.
//
//   x = X / Z,  y = Y / Z,  r2 = x^2 + y^2
//   R = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3)
//   x' = x R + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y R + p1 (r2 + 2 y^2) + 2 p2 x y
//   u = fx0 (1 + fx) x' + cx0 (1 + cx)      v = fy0 (1 + fy) y' + cy0 (1 + cy)
//
// Parameters, in this order: fx fy cx cy (relative).  The distortion is not calibrated: plumb_bob has
// k1 k2 p1 p2 k3, rational_polynomial k1 k2 p1 p2 k3 k4 k5 k6.  It sees points with Z > 0.
//
// K and D describe a raw image, P alone a rectified one.  The point is in the frame of that image:
// P belongs to the rectified camera, which R rotates against the raw one.
// Source: sensor_msgs/CameraInfo; Brown, Decentering Distortion of Lenses, 1966.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// A pinhole camera.
struct PinholeCamera {
  ImageKind image = ImageKind::automatic;  ///< the image its pixels come from

  static constexpr std::string_view kType = "camera2d";  ///< name in configurations
  static constexpr std::array kParameters = {ParameterInfo{"fx"}, ParameterInfo{"fy"},
                                             ParameterInfo{"cx"}, ParameterInfo{"cy"}};
  static constexpr std::size_t kSettings = 12;  ///< fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6
  static constexpr bool kOwnFrame = true;       ///< features are in the optical frame

  /// The recorded settings: of a raw image from K and D, of a rectified one from P.
  /// @throws SettingsError  if they are missing or impossible, or if a raw image has a distortion
  ///                        other than plumb_bob and rational_polynomial
  [[nodiscard]] std::array<double, 12> settings(const Observation& seen) const {
    const CameraInfo& info = camera_info_of(seen);
    const bool raw = is_raw(info, image);
    const std::array<double, 4> intrinsics = intrinsics_of(info, raw);
    std::array<double, 12> s = {intrinsics[0], intrinsics[1], intrinsics[2], intrinsics[3]};
    if (raw) add_distortion(info, s);
    if (image != ImageKind::automatic && s[0] == 0.0 && s[1] == 0.0) {
      throw SettingsError(raw ? "K of camera_info is zero, but the image is raw"
                              : "P of camera_info is zero, but the image is rectified");
    }
    check_camera_settings(s);
    return s;
  }

  /// Its camera_info with corrected intrinsics.
  /// @param v  (4) fx fy cx cy: relative corrections
  [[nodiscard]] CameraInfo calibrated(const CameraInfo& info,
                                      const std::array<double, 4>& v) const {
    const bool raw = is_raw(info, image) || intrinsics_of(info, true) == intrinsics_of(info, false);
    return calibrated_camera_info(info, v[0], v[1], v[2], v[3],
                                  raw ? ImageKind::raw : ImageKind::rectified);
  }

  /// True for points in front of the camera; lane by lane.
  /// @param p  (3) point, metres, in the camera's optical frame
  template <class S>
  [[nodiscard]] static auto sees(const Vector3<S>& p) {
    return p.z() > S(0.0);
  }
  /// The pixel at which a point appears, if sees() is true.
  /// @param p  (3) point, metres, in the camera's optical frame
  /// @param s  (12) settings
  /// @param v  (4) fx fy cx cy: relative corrections of the recorded intrinsics
  /// @returns  (2) pixel
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p, const std::array<Q, 12>& s,
                                               const std::array<S, 4>& v) const {
    const Eigen::Matrix<S, 2, 1> seen = distorted(S(p.x() / p.z()), S(p.y() / p.z()), s);
    return {s[0] * (1.0 + v[0]) * seen.x() + s[2] * (1.0 + v[2]),
            s[1] * (1.0 + v[1]) * seen.y() + s[3] * (1.0 + v[3])};
  }

  /// The ray of a pixel: direction (x, y, 1).
  /// @param v  (4) as above
  template <class S, class Q>
  [[nodiscard]] Ray<S> place(const Measurement<PinholeCamera, Q>& m,
                             const std::array<S, 4>& v) const {
    const auto& s = m.settings;
    const S fx = s[0] * (1.0 + v[0]), fy = s[1] * (1.0 + v[1]);
    const S u = (m.point.x() - s[2] * (1.0 + v[2])) / fx;
    const S w = (m.point.y() - s[3] * (1.0 + v[3])) / fy;
    S x = u, y = w;
    const int iterations = has_settings(s, 4) ? kUndistortions : 0;
    for (int i = 0; i < iterations; ++i) {
      const Eigen::Matrix<S, 2, 1> seen = distorted(x, y, s);
      x = x + (u - seen.x());
      y = y + (w - seen.y());
    }
    const S zero(0.0), one(1.0);
    return {
        .direction = {x, y, one}, .by_u = {one / fx, zero, zero}, .by_v = {zero, one / fy, zero}};
  }

 private:
  static constexpr int kUndistortions = 30;  ///< fixed-point iterations

  /// Fills in k1 k2 p1 p2 k3 k4 k5 k6.
  static void add_distortion(const CameraInfo& info, std::array<double, 12>& s) {
    const std::string& model = info.distortion_model;
    const bool is_rational = model == "rational_polynomial";
    for (std::size_t i = 0; i < info.d.size(); ++i) {
      if (info.d[i] == 0.0) continue;
      if (!model.empty() && model != "plumb_bob" && !is_rational) {
        throw SettingsError("distortion model '" + model +
                            "' is not supported in raw images; rectify them and write 'image: "
                            "rectified' in the model, or use plumb_bob or rational_polynomial");
      }
      if (i >= (is_rational ? 8U : 5U) || !std::isfinite(info.d[i])) {
        throw SettingsError(is_rational
                                ? "rational_polynomial has eight distortion coefficients that are "
                                  "not zero, each a number"
                                : "plumb_bob has five distortion coefficients, each a number");
      }
      s[4 + i] = info.d[i];
    }
  }

  /// True if some lane has a setting from `first` on that is not zero.
  template <class Q>
  [[nodiscard]] static bool has_settings(const std::array<Q, 12>& s, std::size_t first) {
    for (std::size_t k = first; k < s.size(); ++k) {
      for (int i = 0; i < kLanes<Q>; ++i) {
        if (lane(s[k], i) != 0.0) return true;
      }
    }
    return false;
  }

  template <class S, class Q>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> distorted(const S& x, const S& y,
                                                        const std::array<Q, 12>& s) {
    const S xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy;
    S radial = 1.0 + r2 * (s[4] + r2 * (s[5] + r2 * s[8]));
    if (has_settings(s, 9)) radial = radial / (1.0 + r2 * (s[9] + r2 * (s[10] + r2 * s[11])));
    return {x * radial + 2.0 * (s[6] * xy) + s[7] * (r2 + 2.0 * xx),
            y * radial + s[6] * (r2 + 2.0 * yy) + 2.0 * (s[7] * xy)};
  }
};

}  // namespace kinecal
