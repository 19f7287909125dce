// What lenses have in common that bend the image of a pinhole: x = X / Z, y = Y / Z go to
//
//   x' = x R + 2 p1 x y + p2 (r2 + 2 x^2) + s1 r2 + s2 r2^2
//   y' = y R + p1 (r2 + 2 y^2) + 2 p2 x y + s3 r2 + s4 r2^2
//
// A lens L gives L::radial(r2, d) = R, a function of r2 = x^2 + y^2, and L::radial_slope(r2, d) = dR/dr2.  p1 and p2
// are its third and fourth coefficient, s1 to s4 the last of twelve.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

#include "kinecal/sensors/lenses/lens_model.hpp"

namespace kinecal::detail {

/// A lens with N coefficients that bends the image of a pinhole.
template <class L, std::size_t N>
struct PinholeLens {
  static constexpr bool kBendsPinhole =
      true;  ///< contains the lenses with fewer coefficients that do

  /// True for points in front of the camera; lane by lane.
  template <class S>
  [[nodiscard]] static auto sees(const Vector3<S>& p) {
    return p.z() > S(0.0);
  }
  /// Where the image of a point is, if sees() is true.
  /// @param p  (3) metres, in the optical frame
  /// @returns  (2) focal lengths from the principal point
  template <class S, class C>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> image(const Vector3<S>& p,
                                                    const std::array<C, N>& d) {
    return bent<S>(S(p.x() / p.z()), S(p.y() / p.z()), d);
  }
  /// What is seen at a place of the image, by Newton's method, whose last step is in S: so the derivatives
  /// are exact.  Not a number where the image of no point is, as beyond the fold of a lens.
  /// @param at  (2) as image() returns
  template <class S, class C>
  [[nodiscard]] static Sight<S> sight(const Eigen::Matrix<S, 2, 1>& at, const std::array<C, N>& d) {
    using Q = ValueOf<S>;
    const S one(1.0), zero(0.0);
    if (are_zero(d)) return {{at.x(), at.y(), one}, {one, zero, zero}, {zero, one, zero}};
    const std::array<Q, N> known = values_of(d);
    Eigen::Matrix<Q, 2, 1> to(value_of(at.x()), value_of(at.y())), p = to;
    bool moves = true;
    for (int step = 0; step < kMostNewtonSteps && moves; ++step) {
      const Eigen::Matrix<Q, 2, 1> seen = bent<Q>(p.x(), p.y(), known);
      const auto move =
          quotient(slopes<Q>(p.x(), p.y(), known), Q(to.x() - seen.x()), Q(to.y() - seen.y()));
      p.x() = p.x() + move.x();
      p.y() = p.y() + move.y();
      moves = any_above(kSmallNewtonStep, Q(abs(move.x()) + abs(move.y())),
                        Q(1.0 + abs(p.x()) + abs(p.y())));
    }
    const Eigen::Matrix<Q, 2, 2> by_place = slopes<Q>(p.x(), p.y(), known);
    const Eigen::Matrix<S, 2, 1> seen = bent<S>(S(p.x()), S(p.y()), d);
    const auto move = quotient(by_place, S(at.x() - seen.x()), S(at.y() - seen.y()));
    const Q off = abs(value_of(move.x())) + abs(value_of(move.y()));
    const Q upright = by_place(0, 0) * by_place(1, 1) - by_place(0, 1) * by_place(1, 0);
    const Q lost = zero_if_less(off, Q(1e-9 * (1.0 + abs(p.x()) + abs(p.y())))) +
                   zero_if_less(Q(0.0), upright);
    const S x = S(p.x()) + move.x() + S(lost), y = S(p.y()) + move.y() + S(lost);
    const Eigen::Matrix<S, 2, 2> slope = slopes<S>(x, y, d);
    const auto by_x = quotient(slope, one, zero), by_y = quotient(slope, zero, one);
    return {{x, y, one}, {by_x.x(), by_x.y(), zero}, {by_y.x(), by_y.y(), zero}};
  }

 private:
  static constexpr bool kHasPrism = N == 12;

  /// Where the pinhole's image (x, y) goes.
  template <class S, class C>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> bent(const S& x, const S& y,
                                                   const std::array<C, N>& d) {
    const S xx = x * x, yy = y * y, xy = x * y, r2 = xx + yy, radial = L::template radial<S>(r2, d);
    Eigen::Matrix<S, 2, 1> to(x * radial + 2.0 * (d[2] * xy) + d[3] * (r2 + 2.0 * xx),
                              y * radial + d[2] * (r2 + 2.0 * yy) + 2.0 * (d[3] * xy));
    if constexpr (kHasPrism) {
      to.x() = to.x() + r2 * (d[8] + r2 * d[9]);
      to.y() = to.y() + r2 * (d[10] + r2 * d[11]);
    }
    return to;
  }
  /// (2 x 2) derivative of that by x and y.
  template <class S, class C>
  [[nodiscard]] static Eigen::Matrix<S, 2, 2> slopes(const S& x, const S& y,
                                                     const std::array<C, N>& d) {
    const S r2 = x * x + y * y, radial = L::template radial<S>(r2, d);
    const S slope = L::template radial_slope<S>(r2, d);
    const S mixed = 2.0 * (x * y * slope) + 2.0 * (d[2] * x + d[3] * y);
    Eigen::Matrix<S, 2, 2> by_place;
    by_place << radial + 2.0 * (x * x * slope) + 2.0 * (d[2] * y) + 6.0 * (d[3] * x), mixed,  //
        mixed, radial + 2.0 * (y * y * slope) + 6.0 * (d[2] * y) + 2.0 * (d[3] * x);
    if constexpr (kHasPrism) {
      const S sx = 2.0 * (d[8] + 2.0 * (r2 * d[9])), sy = 2.0 * (d[10] + 2.0 * (r2 * d[11]));
      by_place(0, 0) = by_place(0, 0) + x * sx;
      by_place(0, 1) = by_place(0, 1) + y * sx;
      by_place(1, 0) = by_place(1, 0) + x * sy;
      by_place(1, 1) = by_place(1, 1) + y * sy;
    }
    return by_place;
  }
  /// a^-1 (x, y) of a (2 x 2) matrix.
  template <class A, class S>
  [[nodiscard]] static Eigen::Matrix<S, 2, 1> quotient(const Eigen::Matrix<A, 2, 2>& a, const S& x,
                                                       const S& y) {
    const A det = a(0, 0) * a(1, 1) - a(0, 1) * a(1, 0);
    return {S((x * a(1, 1) - y * a(0, 1)) / det), S((y * a(0, 0) - x * a(1, 0)) / det)};
  }
};

}  // namespace kinecal::detail
