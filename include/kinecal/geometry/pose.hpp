// A rigid-body pose: rotation and translation, in any scalar.
//
// base_T_tip maps coordinates in tip to base: p_base = base_T_tip * p_tip.  Products take two
// scalars, so a pose of doubles multiplies one of jets or packets without conversion.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/packet.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/geometry/scalar.hpp"

namespace kinecal {

/// M v for a matrix and a vector of different scalars.
template <class S, class U>
[[nodiscard]] auto rotated(const Matrix3<S>& m, const Vector3<U>& v) {
  using R = Product<S, U>;
  return Vector3<R>(sum_of_products<R>(m(0, 0), v(0), m(0, 1), v(1), m(0, 2), v(2)),
                    sum_of_products<R>(m(1, 0), v(0), m(1, 1), v(1), m(1, 2), v(2)),
                    sum_of_products<R>(m(2, 0), v(0), m(2, 1), v(1), m(2, 2), v(2)));
}

/// A rotation followed by a translation: p -> rotation p + translation.
template <class S>
struct Pose {
  // Explicit values: g++ 12 crashes on a call of Identity() or Zero() here when a Joint in a list
  // has {} or nothing for its origin.
  Matrix3<S> rotation = typename Matrix3<S>::IdentityReturnType(3, 3);  ///< (3 x 3)
  Vector3<S> translation = Vector3<S>(S(0), S(0), S(0));                ///< (3) metres

  /// tip_T_base of base_T_tip.
  [[nodiscard]] Pose inverse() const {
    Pose other;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) other.rotation(r, c) = rotation(c, r);
    }
    other.translation = rotated(other.rotation, translation);
    for (int r = 0; r < 3; ++r) other.translation(r) = -other.translation(r);
    return other;
  }

  /// p_base = base_T_tip * p_tip, metres.
  template <class U>
  [[nodiscard]] auto operator*(const Vector3<U>& p) const {
    auto moved = rotated(rotation, p);
    for (int r = 0; r < 3; ++r) moved(r) = Product<S, U>(moved(r) + translation(r));
    return moved;
  }

  /// a_T_c = a_T_b * b_T_c.
  template <class U>
  [[nodiscard]] auto operator*(const Pose<U>& other) const {
    using R = Product<S, U>;
    Pose<R> product;
    for (int c = 0; c < 3; ++c) {
      const Vector3<U> column(other.rotation(0, c), other.rotation(1, c), other.rotation(2, c));
      const Vector3<R> turned = rotated(rotation, column);
      for (int r = 0; r < 3; ++r) product.rotation(r, c) = turned(r);
    }
    product.translation = *this * other.translation;
    return product;
  }
};

/// to = from.  Copies packets number by number: compilers keep the numbers in registers but copy a
/// whole packet through memory.
template <class S>
void copy_numbers(const Pose<S>& from, Pose<S>& to) {
  if constexpr (kLanes<S> == 1) {
    to = from;
    return;
  }
  for (int r = 0; r < 3; ++r) {
    to.rotation(r, 0) = from.rotation(r, 0);
    to.rotation(r, 1) = from.rotation(r, 1);
    to.rotation(r, 2) = from.rotation(r, 2);
    to.translation(r) = from.translation(r);
  }
}

/// One lane of a matrix of packets or numbers.
template <class S, int R, int C>
[[nodiscard]] Eigen::Matrix<double, R, C> lane_of(const Eigen::Matrix<S, R, C>& m, int i) {
  Eigen::Matrix<double, R, C> of_lane;
  for (Eigen::Index k = 0; k < m.size(); ++k) of_lane.data()[k] = lane(m.data()[k], i);
  return of_lane;
}

}  // namespace kinecal
