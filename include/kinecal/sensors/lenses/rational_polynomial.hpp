// The lens of wide cameras (rational_polynomial): a pinhole whose radial distortion is a quotient.
//
//   x = X / Z,  y = Y / Z,  r2 = x^2 + y^2
//   R = (1 + k1 r2 + k2 r2^2 + k3 r2^3) / (1 + k4 r2 + k5 r2^2 + k6 r2^3)
//   x' = x R + 2 p1 x y + p2 (r2 + 2 x^2) + s1 r2 + s2 r2^2
//   y' = y R + p1 (r2 + 2 y^2) + 2 p2 x y + s3 r2 + s4 r2^2
//
// Coefficients, in this order: k1 k2 p1 p2 k3 k4 k5 k6, and s1 s2 s3 s4 of a thin prism.  It sees points
// with Z > 0, up to almost 90 degrees from the axis.
// Source: OpenCV, calib3d (CALIB_RATIONAL_MODEL, CALIB_THIN_PRISM_MODEL); Claus and Fitzgibbon, A Rational Function
// Lens Distortion Model, 2005.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lenses/pinhole_lens.ipp"

namespace kinecal {

namespace detail {

/// A lens whose R is a quotient.
template <class L, std::size_t N>
struct QuotientLens : PinholeLens<L, N> {
  /// R, and its derivative by r2.
  /// @{
  template <class S, class C>
  [[nodiscard]] static S radial(const S& r2, const std::array<C, N>& d) {
    const S above = 1.0 + r2 * (d[0] + r2 * (d[1] + r2 * d[4]));
    if (are_zero(std::array{d[5], d[6], d[7]})) return above;
    return above / (1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7])));
  }
  template <class S, class C>
  [[nodiscard]] static S radial_slope(const S& r2, const std::array<C, N>& d) {
    const S below = 1.0 + r2 * (d[5] + r2 * (d[6] + r2 * d[7]));
    const S above_slope = d[0] + r2 * (2.0 * d[1] + r2 * (3.0 * d[4]));
    const S below_slope = d[5] + r2 * (2.0 * d[6] + r2 * (3.0 * d[7]));
    return (above_slope - radial<S>(r2, d) * below_slope) / below;
  }
  /// @}
};

}  // namespace detail

/// A pinhole whose radial distortion is a quotient.
struct RationalPolynomial : detail::QuotientLens<RationalPolynomial, 8> {
  static constexpr std::string_view kName =
      "rational_polynomial";  ///< distortion_model of camera_info
  static constexpr std::array<std::string_view, 1> kAlso = {"rational"};  ///< in files
  static constexpr std::array kCoefficients = {
      ParameterInfo{"k1"}, ParameterInfo{"k2"}, ParameterInfo{"p1"},
      ParameterInfo{"p2"}, ParameterInfo{"k3"}, ParameterInfo{"k4"},
      ParameterInfo{"k5"}, ParameterInfo{"k6"}};  ///< in the order of D
};

/// The same behind a thin prism: a lens that is not quite centred on the sensor.
struct ThinPrism : detail::QuotientLens<ThinPrism, 12> {
  static constexpr std::string_view kName = "thin_prism";  ///< files say rational_polynomial
  static constexpr std::array kCoefficients = {
      ParameterInfo{"k1"}, ParameterInfo{"k2"}, ParameterInfo{"p1"},
      ParameterInfo{"p2"}, ParameterInfo{"k3"}, ParameterInfo{"k4"},
      ParameterInfo{"k5"}, ParameterInfo{"k6"}, ParameterInfo{"s1"},
      ParameterInfo{"s2"}, ParameterInfo{"s3"}, ParameterInfo{"s4"}};  ///< in the order of D
};

}  // namespace kinecal
