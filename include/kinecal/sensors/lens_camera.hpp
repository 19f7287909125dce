// A camera with a lens (camera2d): projects a point to a pixel, and a pixel to its ray.
//
//   u = fx0 (1 + fx) x' + cx0 (1 + cx)      v = fy0 (1 + fy) y' + cy0 (1 + cy)
//
// (x', y') is where the lens images the point, in focal lengths, with the coefficients d0 + d.
//
// Parameters, in this order: fx fy cx cy (relative), d (added), as the lens names them: k1 k2 ...
//
// K and D describe a raw image, P alone a rectified one, which has no distortion.  The point is in the frame of that
// image: P belongs to the rectified camera, which R rotates against the raw one.
// Source: sensor_msgs/CameraInfo.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <utility>

#include "kinecal/sensors/camera_image.hpp"
#include "kinecal/sensors/lenses/lens_names.hpp"
#include "kinecal/sensors/lenses/lenses.hpp"
#include "kinecal/sensors/sensor.hpp"

namespace kinecal {

/// Number of a camera's parameters before those of its lens: fx fy cx cy.
inline constexpr std::size_t kIntrinsics = 4;

namespace detail {
/// The parameters of a camera: fx fy cx cy, and the coefficients of its lens.
template <class L, std::size_t... I>
[[nodiscard]] constexpr std::array<ParameterInfo, kIntrinsics + sizeof...(I)> camera_parameters(
    std::index_sequence<I...>) {
  return {ParameterInfo{"fx"}, ParameterInfo{"fy"}, ParameterInfo{"cx"}, ParameterInfo{"cy"},
          L::kCoefficients[I]...};
}
}  // namespace detail

/// A camera with a lens.
template <LensModel L>
struct LensCamera {
  ImageKind image = ImageKind::automatic;  ///< the image its pixels come from

  static constexpr std::size_t kCoefficients = L::kCoefficients.size();  ///< of the lens
  static constexpr std::string_view kType = "camera2d";                  ///< name in configurations
  static constexpr std::string_view kLens = L::kName;                    ///< `lens:` there
  static constexpr std::size_t kUsuallyFree = kIntrinsics;               ///< fx fy cx cy
  static constexpr std::size_t kSettings = 4 + kCoefficients;            ///< fx fy cx cy, D
  static constexpr bool kOwnFrame = true;  ///< features are in the optical frame
  /// fx fy cx cy and the coefficients.
  static constexpr std::array kParameters =
      detail::camera_parameters<L>(std::make_index_sequence<kCoefficients>());
  using Settings = std::array<double, kSettings>;  ///< of an observation

  /// The recorded settings: of a raw image from K and D, of a rectified one from P.
  /// @throws SettingsError  if they are missing or impossible, or if the distortion of a raw image is of another lens
  [[nodiscard]] Settings settings(const Observation& seen) const {
    const CameraInfo& info = camera_info_of(seen);
    const bool raw = is_raw(info, image, kLens);
    const std::array<double, 4> intrinsics = intrinsics_of(info, raw);
    Settings s{};
    std::copy_n(intrinsics.begin(), 4, s.begin());
    if (raw) {
      const std::vector<double> d = coefficients_of(info, kLens, kCoefficients);
      std::copy_n(d.begin(), kCoefficients, s.begin() + 4);
    }
    if (image != ImageKind::automatic && s[0] == 0.0 && s[1] == 0.0) {
      throw SettingsError(raw ? "K of camera_info is zero, but the image is raw"
                              : "P of camera_info is zero, but the image is rectified");
    }
    check_camera_settings(s);
    return s;
  }
  /// Settings that contain the coefficients of the parameters.
  /// @param v  (4 + N) parameters
  template <class Q>
  [[nodiscard]] static std::array<Q, kSettings> with_held(std::array<Q, kSettings> s,
                                                          std::span<const double> v) {
    for (std::size_t i = 4; i < kSettings; ++i) s[i] = s[i] + Q(v[i]);
    return s;
  }
  /// Its camera_info with corrected intrinsics and coefficients.
  /// @param v  (4 + N) parameters
  /// @throws std::invalid_argument  if coefficients of a rectified image have changed, which has none
  [[nodiscard]] CameraInfo calibrated(const CameraInfo& info, const Settings& v) const {
    const bool raw =
        is_raw(info, image, kLens) || intrinsics_of(info, true) == intrinsics_of(info, false);
    CameraInfo now = calibrated_camera_info(info, v[0], v[1], v[2], v[3],
                                            raw ? ImageKind::raw : ImageKind::rectified);
    set_coefficients(now, kLens, L::kCoefficients, std::span(v).subspan(4), raw);
    return now;
  }

  /// The pixel at which a point appears, if the lens sees it.
  /// @param p  (3) point, metres, in the camera's optical frame
  /// @param s  (4 + N) settings
  /// @param v  (4 + N) parameters; or (4) fx fy cx cy, then s has the coefficients
  /// @returns  (2) pixel
  /// @{
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p,
                                               const std::array<Q, kSettings>& s,
                                               const std::array<S, kSettings>& v) const {
    return pixel(L::image(p, coefficients(s, v)), s, v);
  }
  template <class S, class Q>
  [[nodiscard]] Eigen::Matrix<S, 2, 1> predict(const Vector3<S>& p,
                                               const std::array<Q, kSettings>& s,
                                               const std::array<S, 4>& v) const {
    return pixel(L::image(p, recorded(s)), s, v);
  }
  /// @}

  /// The ray of a pixel.
  /// @param v  (4 + N) or (4) as above
  /// @{
  template <class S, class Q>
  [[nodiscard]] Ray<S> place(const Measurement<LensCamera, Q>& m,
                             const std::array<S, kSettings>& v) const {
    return ray(m, v, coefficients(m.settings, v));
  }
  template <class S, class Q>
  [[nodiscard]] Ray<S> place(const Measurement<LensCamera, Q>& m, const std::array<S, 4>& v) const {
    return ray(m, v, recorded(m.settings));
  }
  /// @}

 private:
  template <class Q>
  [[nodiscard]] static std::array<Q, kCoefficients> recorded(const std::array<Q, kSettings>& s) {
    std::array<Q, kCoefficients> d;
    std::copy_n(s.begin() + 4, kCoefficients, d.begin());
    return d;
  }
  template <class S, class Q>
  [[nodiscard]] static std::array<S, kCoefficients> coefficients(
      const std::array<Q, kSettings>& s, const std::array<S, kSettings>& v) {
    std::array<S, kCoefficients> d;
    for (std::size_t i = 0; i < kCoefficients; ++i) d[i] = S(s[4 + i] + v[4 + i]);
    return d;
  }
  template <class S, class Q, std::size_t N>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> pixel(const Eigen::Matrix<S, 2, 1>& at,
                                                    const std::array<Q, kSettings>& s,
                                                    const std::array<S, N>& v) {
    return {s[0] * (1.0 + v[0]) * at.x() + s[2] * (1.0 + v[2]),
            s[1] * (1.0 + v[1]) * at.y() + s[3] * (1.0 + v[3])};
  }
  template <class S, class Q, class C, std::size_t N>
  [[nodiscard]] static Ray<S> ray(const Measurement<LensCamera, Q>& m, const std::array<S, N>& v,
                                  const std::array<C, kCoefficients>& d) {
    const auto& s = m.settings;
    const S fx = s[0] * (1.0 + v[0]), fy = s[1] * (1.0 + v[1]);
    const Eigen::Matrix<S, 2, 1> at((m.point.x() - s[2] * (1.0 + v[2])) / fx,
                                    (m.point.y() - s[3] * (1.0 + v[3])) / fy);
    const Sight<S> seen = detail::sight_of<L>(at, d);
    Ray<S> ray{.direction = seen.direction};
    for (int i = 0; i < 3; ++i) {
      ray.by_u(i) = seen.by_x(i) / fx;
      ray.by_v(i) = seen.by_y(i) / fy;
    }
    return ray;
  }

 public:
  /// False for points that the lens does not see though predict() gives a pixel; lane by lane.
  /// @param p  (3) point, metres, in the camera's optical frame
  template <class S>
  [[nodiscard]] static auto sees(const Vector3<S>& p) requires requires {
    L::sees(p);
  }
  { return L::sees(p); }
};

/// A camera whose lens is a pinhole with or without distortion, by plumb_bob or rational_polynomial.
using PinholeCamera = LensCamera<RationalPolynomial>;

}  // namespace kinecal
