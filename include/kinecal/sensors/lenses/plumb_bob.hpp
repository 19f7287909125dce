// The lens of most cameras (plumb_bob; radtan in Kalibr): a pinhole with radial and tangential distortion.
//
//   x = X / Z,  y = Y / Z,  r2 = x^2 + y^2,  R = 1 + k1 r2 + k2 r2^2 + k3 r2^3
//   x' = x R + 2 p1 x y + p2 (r2 + 2 x^2)
//   y' = y R + p1 (r2 + 2 y^2) + 2 p2 x y
//
// Coefficients, in this order: k1 k2 p1 p2 k3.  It sees points with Z > 0.  R is a polynomial in the
// tangent of the angle from the axis, which grows beyond all bounds: for angles up to 50 degrees or so.
// Source: Brown, Decentering Distortion of Lenses, 1966; OpenCV, calib3d.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lenses/pinhole_lens.ipp"

namespace kinecal {

/// A pinhole with radial and tangential distortion.
struct PlumbBob : detail::PinholeLens<PlumbBob, 5> {
  static constexpr std::string_view kName = "plumb_bob";  ///< distortion_model of camera_info
  static constexpr std::array<std::string_view, 2> kAlso = {"radtan",
                                                            "brown_conrady"};  ///< in files
  static constexpr std::array kCoefficients = {ParameterInfo{"k1"}, ParameterInfo{"k2"},
                                               ParameterInfo{"p1"}, ParameterInfo{"p2"},
                                               ParameterInfo{"k3"}};  ///< in the order of D

  /// R, and its derivative by r2.
  /// @{
  template <class S, class C>
  [[nodiscard]] static S radial(const S& r2, const std::array<C, 5>& d) {
    return 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
  }
  template <class S, class C>
  [[nodiscard]] static S radial_slope(const S& r2, const std::array<C, 5>& d) {
    return d[0] + r2 * (2.0 * d[1] + r2 * (3.0 * d[4]));
  }
  /// @}
};

}  // namespace kinecal
