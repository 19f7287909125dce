// A rigid-body pose: rotation and translation, in any scalar.
//
// base_T_tip maps coordinates in tip to base: p_base = base_T_tip * p_tip.  The products are
// written out over both scalars, so that a pose of doubles multiplies one of Jets or packets
// without being converted first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// M v for a matrix and a vector of different scalars.
template <class S, class U>
[[nodiscard]] auto rotated(const Matrix3<S>& m, const Vector3<U>& v) {
  using R = decltype(m(0, 0) * v(0));
  return Vector3<R>(m(0, 0) * v(0) + m(0, 1) * v(1) + m(0, 2) * v(2),
                    m(1, 0) * v(0) + m(1, 1) * v(1) + m(1, 2) * v(2),
                    m(2, 0) * v(0) + m(2, 1) * v(1) + m(2, 2) * v(2));
}

template <class S>
struct Pose {
  Matrix3<S> rotation = Matrix3<S>::Identity();
  Vector3<S> translation = Vector3<S>::Zero();

  [[nodiscard]] Pose inverse() const {
    const Matrix3<S> transposed = rotation.transpose();
    return {transposed, -rotated(transposed, translation)};
  }

  template <class U>
  [[nodiscard]] auto operator*(const Vector3<U>& p) const {
    using R = decltype(rotation(0, 0) * p(0));
    return Vector3<R>(rotated(rotation, p) + translation);
  }

  template <class U>
  [[nodiscard]] auto operator*(const Pose<U>& other) const {
    using R = decltype(rotation(0, 0) * other.rotation(0, 0));
    Pose<R> product;
    for (int c = 0; c < 3; ++c) {
      product.rotation.col(c) = rotated(rotation, Vector3<U>(other.rotation.col(c)));
    }
    product.translation = *this * other.translation;
    return product;
  }
};

}  // namespace kinecal
