// Motions in the plane: a rotation about z and a translation in x and y, SE(2).
//
//   exp(vx, vy, w):  an arc of constant curvature, of angle w; its chord lies half of w to the left of its beginning
//
//   t = sin(w/2) / (w/2) R(w/2) (vx, vy)
//
// Source: Sola, Deray, Atchuthan, A micro Lie theory for state estimation in robotics, 2018, appendix C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// A motion in the plane, or the planar pose of a frame: a_T_b.
template <class S>
struct PlanarMotion {
  S x{0.0}, y{0.0};  ///< translation, metres
  S cosine{1.0};     ///< of the rotation
  S sine{0.0};       ///< of the rotation

  /// The pose at x, y, metres, turned by an angle, radians.
  [[nodiscard]] static PlanarMotion at(const S& x, const S& y, const S& angle) {
    using std::cos, std::sin;
    return {x, y, cos(angle), sin(angle)};
  }
  /// b_T_a.
  [[nodiscard]] PlanarMotion inverse() const {
    return {-(cosine * x + sine * y), sine * x - cosine * y, cosine, -sine};
  }
  /// The rotation, radians, in (-pi, pi].
  [[nodiscard]] S angle() const {
    using std::atan2;
    return atan2(sine, cosine);
  }
  /// a_T_b * b_T_c = a_T_c.
  friend PlanarMotion operator*(const PlanarMotion& a, const PlanarMotion& b) {
    return {a.x + a.cosine * b.x - a.sine * b.y, a.y + a.sine * b.x + a.cosine * b.y,
            a.cosine * b.cosine - a.sine * b.sine, a.sine * b.cosine + a.cosine * b.sine};
  }
};

namespace detail {

/// sin(h) / h.
template <class S>
[[nodiscard]] S sinc(const S& h) {
  using std::sin;
  const S squared = h * h;
  const auto is_small = squared < S(1e-4);
  const S other = select(is_small, S(1.0), h);
  const S series = 1.0 - squared * (1.0 / 6.0 - squared * (1.0 / 120.0 - squared / 5040.0));
  return select(is_small, series, S(sin(other) / other));
}

}  // namespace detail

/// Where an arc leads.
/// @param ahead, left  lengths along the axes of the moving frame, metres
/// @param turn         angle, radians; may be more than a turn
template <class S>
[[nodiscard]] PlanarMotion<S> planar_exp(const S& ahead, const S& left, const S& turn) {
  using std::cos, std::sin;
  const S half = 0.5 * turn, chord = detail::sinc(half), c = chord * cos(half),
          s = chord * sin(half);
  return {c * ahead - s * left, s * ahead + c * left, cos(turn), sin(turn)};
}

/// The arc of at most half a turn that leads there: the inverse of planar_exp().
/// @returns  (3) ahead and left, metres; angle, radians
template <class S>
[[nodiscard]] Vector3<S> planar_log(const PlanarMotion<S>& to) {
  using std::cos, std::sin;
  const S turn = to.angle(), half = 0.5 * turn, scale = 1.0 / detail::sinc(half),
          c = scale * cos(half), s = scale * sin(half);
  return {c * to.x + s * to.y, c * to.y - s * to.x, turn};
}

}  // namespace kinecal
