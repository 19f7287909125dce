// Rotations as rotation vectors: exponential, logarithm and left Jacobian.
//
// A rotation vector w points along the axis; its length is the angle in radians.  With t = |w| and
// K = [w]x :
//
//   exp(w) = I + a K + b K^2      a = sin t / t      b = (1 - cos t) / t^2
//   J(w)   = I + b K + c K^2      c = (t - sin t) / t^3
//
// J is the left Jacobian: exp(w + dw) = exp(J(w) dw) exp(w) to first order.  The coefficients are
// even in t, so they are smooth functions of t^2.  Below t = 0.5 they are computed from their
// series, which makes values and derivatives (automatic or by hand) exact at zero.
// Source: Chirikjian, Stochastic Models, Information Theory, and Lie Groups, vol. 2, 10.8.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/geometry/eigen_layout.hpp"

namespace kinecal {

/// (3) column vector of any scalar.
template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
/// (3 x 3) matrix of any scalar.
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;

/// a x b.  Eigen's own version needs a module that takes longer to include than all of geometry/.
template <class S>
[[nodiscard]] Vector3<S> cross(const Vector3<S>& a, const Vector3<S>& b) {
  return {S(S(a.y() * b.z()) - S(a.z() * b.y())), S(S(a.z() * b.x()) - S(a.x() * b.z())),
          S(S(a.x() * b.y()) - S(a.y() * b.x()))};
}

/// The matrix [w]x with [w]x p = w x p.
template <class S>
[[nodiscard]] Matrix3<S> cross_matrix(const Vector3<S>& w) {
  Matrix3<S> k;
  k << S(0), -w.z(), w.y(), w.z(), S(0), -w.x(), -w.y(), w.x(), S(0);
  return k;
}

/// I + a K + b K^2 with K = [w]x, hence K^2 = w w^T - |w|^2 I.
template <class S>
[[nodiscard]] Matrix3<S> cross_polynomial(const Vector3<S>& w, const S& a, const S& b) {
  const S x = w.x(), y = w.y(), z = w.z();
  const S xy = b * (x * y), xz = b * (x * z), yz = b * (y * z);
  Matrix3<S> m;
  m << S(1) - b * (y * y + z * z), xy - a * z, xz + a * y,  //
      xy + a * z, S(1) - b * (x * x + z * z), yz - a * x,   //
      xz - a * y, yz + a * x, S(1) - b * (x * x + y * y);
  return m;
}

/// The coefficients a, b and c of the formulas at the top of this file.
template <class S>
struct RotationCoefficients {
  S a;  ///< sin t / t
  S b;  ///< (1 - cos t) / t^2
  S c;  ///< (t - sin t) / t^3

  /// @param t2  square of the angle, radians^2
  [[nodiscard]] static RotationCoefficients from_squared_angle(const S& t2) {
    using std::cos, std::sin, std::sqrt;
    if (t2 < S(0.25)) return {series(t2, 1), series(t2, 2), series(t2, 3)};
    const S t = sqrt(t2);
    const S half = sin(t * S(0.5));
    return {sin(t) / t, S(2) * half * half / t2, (t - sin(t)) / (t2 * t)};
  }

 private:
  /// Sum over n of (-t2)^n / (2n + k)!, nine terms: the first omitted one is below 1e-22.
  [[nodiscard]] static S series(const S& t2, int k) {
    S sum(0);
    for (int n = 8; n >= 0; --n) {
      // Horner from the inside: each term is the next one times -t2 / ((2n+k+1)(2n+k+2)).
      sum = S(1) - sum * t2 / S(double(2 * n + k + 1) * double(2 * n + k + 2));
    }
    return sum / S(k == 3 ? 6.0 : k);  // k! for k = 1, 2, 3
  }
};

/// Rotation matrix of a rotation vector.
/// @param w  (3) rotation vector, radians
template <class S>
[[nodiscard]] Matrix3<S> exp(const Vector3<S>& w) {
  const auto k = RotationCoefficients<S>::from_squared_angle(w.squaredNorm());
  return cross_polynomial(w, k.a, k.b);
}

/// Left Jacobian of exp at w: a change dw of the rotation vector turns the body by J dw.
/// @param w  (3) rotation vector, radians
template <class S>
[[nodiscard]] Matrix3<S> left_jacobian(const Vector3<S>& w) {
  const auto k = RotationCoefficients<S>::from_squared_angle(w.squaredNorm());
  return cross_polynomial(w, k.b, k.c);
}

namespace detail {

/// Quaternion (x y z w) of a rotation matrix, not normalized.  Starts from the largest of the four
/// components, so it never divides by a small number.
template <class S>
[[nodiscard]] Eigen::Matrix<S, 4, 1> quaternion(const Matrix3<S>& r) {
  const S trace = r(0, 0) + r(1, 1) + r(2, 2);
  int largest = 0;
  for (int i = 1; i < 3; ++i) {
    if (r(largest, largest) < r(i, i)) largest = i;
  }
  Eigen::Matrix<S, 4, 1> q;
  if (r(largest, largest) < trace) {
    q << r(2, 1) - r(1, 2), r(0, 2) - r(2, 0), r(1, 0) - r(0, 1), S(1) + trace;
    return q;
  }
  const int i = largest, j = (i + 1) % 3, k = (i + 2) % 3;
  q(i) = S(1) + r(i, i) - r(j, j) - r(k, k);
  q(j) = r(j, i) + r(i, j);
  q(k) = r(k, i) + r(i, k);
  q(3) = r(k, j) - r(j, k);
  if (q(3) < S(0)) q = -q;
  return q;
}

}  // namespace detail

/// (3 x 3) rotation of a unit quaternion (x y z w).
template <class S>
[[nodiscard]] Matrix3<S> rotation_from_quaternion(const Eigen::Matrix<S, 4, 1>& q) {
  const S x = q(0), y = q(1), z = q(2), w = q(3), two(2);
  Matrix3<S> r;
  r << S(1) - two * (y * y + z * z), two * (x * y - z * w), two * (x * z + y * w),
      two * (x * y + z * w), S(1) - two * (x * x + z * z), two * (y * z - x * w),
      two * (x * z - y * w), two * (y * z + x * w), S(1) - two * (x * x + y * y);
  return r;
}

/// Rotation vector of a rotation matrix, angle in [0, pi]; exact at zero and at pi.  At exactly pi
/// the matrix determines the axis only up to its sign; one of the two is returned.
template <class S>
[[nodiscard]] Vector3<S> log(const Matrix3<S>& r) {
  using std::atan2, std::sqrt;
  const Eigen::Matrix<S, 4, 1> q = detail::quaternion(r);
  const Vector3<S> v = q.template head<3>();
  const S w = q(3), v2 = v.squaredNorm(), w2 = w * w;
  if (v2 < w2 * S(1e-4)) {  // 2 atan(x)/x with x = |v|/w by its series, smooth at zero
    const S x2 = v2 / w2;
    const S factor =
        S(1) - x2 * (S(1.0 / 3) - x2 * (S(1.0 / 5) - x2 * (S(1.0 / 7) - x2 * S(1.0 / 9))));
    return v * (S(2) * factor / w);
  }
  const S norm = sqrt(v2);
  return v * (S(2) * atan2(norm, w) / norm);
}

}  // namespace kinecal
