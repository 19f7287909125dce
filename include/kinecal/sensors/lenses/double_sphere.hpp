// A fisheye lens with two coefficients (double_sphere; ds in Kalibr): the point falls on a unit sphere, on a
// second one whose centre is xi further, and from there into the image of a pinhole that stands
// alpha / (1 - alpha) before that centre.
//
//   d1 = |(X, Y, Z)|,  k = xi d1 + Z,  d2 = |(X, Y, k)|
//   x' = X / (alpha d2 + (1 - alpha) k),  y' = Y / (alpha d2 + (1 - alpha) k)
//
// Coefficients, in this order: xi, alpha.  xi = alpha = 0 is a pinhole.  It sees points with Z > -w2 d1, w2 =
// (w1 + xi) / sqrt(2 w1 xi + xi^2 + 1), w1 = alpha / (1 - alpha) or its inverse, the smaller one; where alpha > 1/2,
// its image ends at the radius 1 / sqrt(2 alpha - 1).  It is inverted in closed form.
// Source: Usenko, Demmel and Cremers, The Double Sphere Camera Model, 2018.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/sensors/lenses/round_lens.ipp"

namespace kinecal {

/// A fisheye lens with two coefficients.
struct DoubleSphere {
  static constexpr std::string_view kName = "double_sphere";  ///< distortion_model of camera_info
  static constexpr std::array<std::string_view, 1> kAlso = {"ds"};  ///< in files
  static constexpr std::array kCoefficients = {ParameterInfo{"xi"},
                                               ParameterInfo{"alpha"}};  ///< in the order of D

  /// Where the image of a point is; not a number outside of what it sees.
  /// @param p  (3) metres, in the optical frame
  /// @param d  (2) coefficients
  /// @returns  (2) focal lengths from the principal point
  template <class S, class C>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> image(const Vector3<S>& p,
                                                    const std::array<C, 2>& d) {
    using std::sqrt;
    const S xi(d[0]), alpha(d[1]);
    const S r2 = p.x() * p.x() + p.y() * p.y();
    const S d1 = sqrt(S(r2 + p.z() * p.z())), k = xi * d1 + p.z(), d2 = sqrt(S(r2 + k * k));
    const S below = alpha * d2 + (1.0 - alpha) * k;
    const auto flat = alpha > S(0.5);
    const S w1 = select(flat, S(1.0 - alpha), alpha) / select(flat, alpha, S(1.0 - alpha));
    const S w2 = (w1 + xi) / sqrt(S(2.0 * (w1 * xi) + xi * xi + 1.0));
    using Q = ValueOf<S>;
    const S unseen(detail::zero_if_less(value_of(S(-(w2 * d1))), value_of(p.z())) +
                   detail::zero_if_less(Q(0.0), value_of(below)));
    return {p.x() / below + unseen, p.y() / below + unseen};
  }
  /// What is seen at a place of the image; not a number outside of it.
  /// @param at  (2) as image() returns
  template <class S, class C>
  [[nodiscard]] static Sight<S> sight(const Eigen::Matrix<S, 2, 1>& at, const std::array<C, 2>& d) {
    using std::sqrt;
    const S xi(d[0]), alpha(d[1]), q = at.x() * at.x() + at.y() * at.y();
    const S twice = 2.0 * alpha - 1.0, root = sqrt(S(1.0 - twice * q));
    const S below = alpha * root + (1.0 - alpha);
    const S z = (1.0 - alpha * alpha * q) / below;  // on the second sphere
    const S z_slope = (z * alpha * twice / (2.0 * root) - alpha * alpha) / below;
    const S rest = 1.0 - xi * xi, w = sqrt(S(z * z + rest * q));
    const S w_slope = (2.0 * (z * z_slope) + rest) / (2.0 * w);
    const S length = z * z + q, a = (z * xi + w) / length;
    const S a_slope = (z_slope * xi + w_slope - a * (2.0 * (z * z_slope) + 1.0)) / length;
    return detail::round_sight<S>(at, a, a_slope, S(a * z - xi), S(a_slope * z + a * z_slope));
  }
};

}  // namespace kinecal
