// A fisheye lens (equidistant; Kannala and Brandt): the image is as far from the principal point as the
// ray's angle from the axis says.
//
//   r = sqrt(X^2 + Y^2),  t = atan2(r, Z),  t' = t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)
//   x' = t' X / r,  y' = t' Y / r
//
// Coefficients, in this order: k1 k2 k3 k4.  It sees all around, also with Z <= 0, up to the angle at which its image folds
// over; the point just behind it has no image.
// Source: Kannala and Brandt, A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and
// Fish-Eye Lenses, 2006; OpenCV, fisheye; equidistant in ROS and Kalibr.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinecal/sensors/lenses/round_lens.ipp"

namespace kinecal {

/// A fisheye lens.
struct Equidistant {
  static constexpr std::string_view kName = "equidistant";  ///< distortion_model of camera_info
  static constexpr std::array<std::string_view, 5> kAlso = {
      "fisheye", "equi", "kannala_brandt", "kannala_brandt4", "KANNALA_BRANDT4"};  ///< in files
  static constexpr std::array kCoefficients = {ParameterInfo{"k1"}, ParameterInfo{"k2"},
                                               ParameterInfo{"k3"},
                                               ParameterInfo{"k4"}};  ///< in the order of D

  /// Where the image of a point is; not a number beyond the fold and just behind the camera.
  /// @param p  (3) metres, in the optical frame
  /// @param d  (4) coefficients
  /// @returns  (2) focal lengths from the principal point
  template <class S, class C>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> image(const Vector3<S>& p,
                                                    const std::array<C, 4>& d) {
    using std::atan2, std::sqrt;
    const S r2 = p.x() * p.x() + p.y() * p.y(), z2 = p.z() * p.z();
    const auto near_axis = r2 < S(kNear) * z2;
    const S r = sqrt(select(near_axis, S(1.0), r2)), q = r2 / select(near_axis, z2, S(1.0));
    // t / r; near the axis by the series of atan(r / z) / r
    const S slope =
        select(near_axis, S((1.0 - q * (1.0 / 3.0) + q * q * 0.2) / p.z()), S(atan2(r, p.z()) / r));
    const S t2 = slope * slope * r2;
    using Q = ValueOf<S>;
    const Q beside = value_of(r2), z = value_of(p.z());
    const S g = growth<S>(t2, d);
    const S unseen(
        detail::zero_if_less(Q(0.0), select(z > Q(0.0), Q(1.0), beside)) +
        detail::zero_if_less(Q(0.0), value_of(g)) +
        detail::zero_if_less(Q(0.0), square_slope<Q>(value_of(t2), detail::values_of(d))));
    const S scale = slope * g + unseen;
    return {scale * p.x(), scale * p.y()};
  }
  /// What is seen at a place of the image; not a number beyond the one of the angle of 180 degrees.
  /// @param at  (2) as image() returns
  template <class S, class C>
  [[nodiscard]] static Sight<S> sight(const Eigen::Matrix<S, 2, 1>& at, const std::array<C, 4>& d) {
    using std::sqrt, std::sin, std::cos;
    const S q = at.x() * at.x() + at.y() * at.y();
    const S w = squared_angle<S>(q, d), g = growth<S>(w, d), g_slope = growth_slope<S>(w, d);
    // sin(t) / t and cos(t) as functions of w = t^2
    const auto near_axis = w < S(kNear);
    const S t = sqrt(select(near_axis, S(1.0), w));
    const S sinc =
        select(near_axis, S(1.0 - w * (1.0 / 6.0) + w * w * (1.0 / 120.0)), S(sin(t) / t));
    const S cosine = select(near_axis, S(1.0 - w * 0.5 + w * w * (1.0 / 24.0)), S(cos(t)));
    const S sinc_slope = select(near_axis, S(w * (1.0 / 60.0) - 1.0 / 6.0),
                                S((cosine - sinc) / (2.0 * select(near_axis, S(1.0), w))));
    const S w_slope = 1.0 / (g * (g + 2.0 * (w * g_slope)));
    const S a = sinc / g;
    return detail::round_sight<S>(at, a, S((sinc_slope - a * g_slope) / g * w_slope), cosine,
                                  S(-0.5 * (sinc * w_slope)));
  }

 private:
  static constexpr double kNear =
      1e-6;  ///< square of an angle for which three terms of a series are exact

  /// t' / t, and its derivative by t^2.
  /// @{
  template <class S, class C>
  [[nodiscard]] static S growth(const S& w, const std::array<C, 4>& d) {
    return 1.0 + w * (d[0] + w * (d[1] + w * (d[2] + w * d[3])));
  }
  template <class S, class C>
  [[nodiscard]] static S growth_slope(const S& w, const std::array<C, 4>& d) {
    return d[0] + w * (2.0 * d[1] + w * (3.0 * d[2] + w * (4.0 * d[3])));
  }
  /// @}
  /// Derivative of t'^2 by t^2; the lens folds over where it is zero.
  template <class S, class C>
  [[nodiscard]] static S square_slope(const S& w, const std::array<C, 4>& d) {
    const S g = growth<S>(w, d);
    return g * (g + 2.0 * (w * growth_slope<S>(w, d)));
  }
  /// t^2 from t'^2, by Newton's method; its last step is in S.
  template <class S, class C>
  [[nodiscard]] static S squared_angle(const S& q, const std::array<C, 4>& d) {
    using Q = ValueOf<S>;
    const std::array<Q, 4> known = detail::values_of(d);
    const Q goal = value_of(q);
    const auto off = [&](const Q& w) {
      const Q g = growth<Q>(w, known);
      return Q(goal - w * g * g);
    };
    Q w = goal;
    bool moves = true;
    for (int step = 0; step < detail::kMostNewtonSteps && moves; ++step) {
      const Q move = off(w) / square_slope<Q>(w, known);
      w = w + move;
      moves = detail::any_above(detail::kSmallNewtonStep, Q(abs(move)), Q(1.0 + abs(w)));
    }
    const auto is_right = [&] {
      return detail::zero_if_less(Q(abs(off(w))), Q(1e-11 * (1.0 + goal))) +
             detail::zero_if_less(Q(0.0), square_slope<Q>(w, known)) +
             detail::zero_if_less(Q(0.0), growth<Q>(w, known)) +
             detail::zero_if_less(Q(-1e-12), w) + detail::zero_if_less(w, Q(kMostAngle));
    };
    Q lost = is_right();
    for (int i = 0; i < kLanes<Q>; ++i) {
      if (std::isfinite(lane(lost, i))) continue;
      std::array<double, 4> in_lane{};
      for (std::size_t k = 0; k < 4; ++k) in_lane[k] = lane(known[k], i);
      set_lane(w, i, by_halving(lane(goal, i), in_lane));
    }
    lost = is_right();
    const Q last = square_slope<Q>(w, known);
    const S at(w), grown = growth<S>(at, d);
    return at + (q - at * grown * grown) / last + S(lost);
  }
  /// t^2 from t'^2 where Newton's method goes astray: the first one, before the fold.
  [[nodiscard]] static double by_halving(double goal, const std::array<double, 4>& d) {
    constexpr int kSteps = 200;
    const auto square = [&](double w) { return w * growth(w, d) * growth(w, d); };
    double low = 0.0, high = 0.0;
    for (int i = 1; i <= kSteps && square(high) < goal && square(high) >= square(low); ++i) {
      low = high;
      high = kMostAngle * i / kSteps;
    }
    while (high - low > 1e-15 * high) {
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (square(middle) < goal ? low : high) = middle;
    }
    return low;
  }
  static constexpr double kMostAngle = std::numbers::pi * std::numbers::pi;  ///< squared, radians
};

}  // namespace kinecal
