// A jet: a value with its N first derivatives.  Arithmetic on jets differentiates (forward mode).
//
//   f(x + dx) = f(x) + f'(x) dx      Jet<S, 1> x{3.0, 0};  (x * x).v(0) == 6
//
// Small jets (3 to 12 wide) differentiate what a sensor or an error block does with a point;
// kinematics has its own derivatives (kinematics/twist_walker.hpp).  S is double or a packet.
// Comparisons look at the value only.
// Source: Griewank, Walther, Evaluating Derivatives, 3.1.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <concepts>
#include <type_traits>

#include "kinecal/geometry/packet.hpp"

namespace kinecal {

/// A value with its N first derivatives, each of type S.
template <class S, int N>
struct Jet {
  using Gradient = Eigen::Matrix<S, N, 1>;  ///< (N) derivatives

  S a{0.0};                       ///< value
  Gradient v = Gradient::Zero();  ///< derivatives

  Jet() = default;
  /// A constant: all derivatives are zero.
  Jet(const S& value) : a(value) {}  // NOLINT: a number is a jet without derivatives
  /// A constant: all derivatives are zero.
  template <class A>
  requires std::is_arithmetic_v<A> Jet(A value) : a(static_cast<double>(value)) {}  // NOLINT
  /// The k-th variable: its derivative with respect to itself is one, all others are zero.
  Jet(const S& value, int k) : a(value) { v(k) = S(1.0); }
  /// A value with given derivatives.
  Jet(const S& value, const Gradient& gradient) : a(value), v(gradient) {}

  /// Arithmetic: the sum, product and quotient rules.
  /// @{
  Jet operator-() const { return {-a, -v}; }
  Jet& operator+=(const Jet& y) { return *this = *this + y; }
  Jet& operator-=(const Jet& y) { return *this = *this - y; }
  Jet& operator*=(const Jet& y) { return *this = *this * y; }
  Jet& operator/=(const Jet& y) { return *this = *this / y; }

  friend Jet operator+(const Jet& x, const Jet& y) { return {x.a + y.a, x.v + y.v}; }
  friend Jet operator-(const Jet& x, const Jet& y) { return {x.a - y.a, x.v - y.v}; }
  friend Jet operator*(const Jet& x, const Jet& y) { return {x.a * y.a, x.v * y.a + y.v * x.a}; }
  friend Jet operator/(const Jet& x, const Jet& y) {
    const S inverse = S(1.0) / y.a, quotient = x.a * inverse;
    return {quotient, (x.v - y.v * quotient) * inverse};
  }
  friend Jet operator+(const Jet& x, const S& s) { return {x.a + s, x.v}; }
  friend Jet operator+(const S& s, const Jet& x) { return {s + x.a, x.v}; }
  friend Jet operator-(const Jet& x, const S& s) { return {x.a - s, x.v}; }
  friend Jet operator-(const S& s, const Jet& x) { return {s - x.a, -x.v}; }
  friend Jet operator*(const Jet& x, const S& s) { return {x.a * s, x.v * s}; }
  friend Jet operator*(const S& s, const Jet& x) { return x * s; }
  friend Jet operator/(const Jet& x, const S& s) { return x * (S(1.0) / s); }
  /// @}

  /// True for jets of packets, which need separate operators with double.
  static constexpr bool kOfPackets = !std::same_as<S, double>;
  // clang-format off
  /// Arithmetic of a jet of packets with a number.
  /// @{
  friend Jet operator+(const Jet& x, double s) requires kOfPackets { return x + S(s); }
  friend Jet operator+(double s, const Jet& x) requires kOfPackets { return S(s) + x; }
  friend Jet operator-(const Jet& x, double s) requires kOfPackets { return x - S(s); }
  friend Jet operator-(double s, const Jet& x) requires kOfPackets { return S(s) - x; }
  friend Jet operator*(const Jet& x, double s) requires kOfPackets { return x * S(s); }
  friend Jet operator*(double s, const Jet& x) requires kOfPackets { return S(s) * x; }
  friend Jet operator/(const Jet& x, double s) requires kOfPackets { return x / S(s); }
  friend Jet operator/(double s, const Jet& x) requires kOfPackets { return Jet(S(s)) / x; }
  /// @}
  // clang-format on

  /// Comparison of the values.  Packets give a mask, one answer per lane: see select() in
  /// geometry/packet.hpp.
  /// @{
  friend auto operator==(const Jet& x, const Jet& y) { return x.a == y.a; }
  friend auto operator<(const Jet& x, const Jet& y) { return x.a < y.a; }
  friend auto operator>(const Jet& x, const Jet& y) { return x.a > y.a; }
  friend auto operator<=(const Jet& x, const Jet& y) { return x.a <= y.a; }
  friend auto operator>=(const Jet& x, const Jet& y) { return x.a >= y.a; }
  /// @}

  /// x where the condition holds, else y; lane by lane.
  template <class Mask>
  friend Jet select(const Mask& condition, const Jet& x, const Jet& y) {
    using kinecal::select;  // beside that of jets of jets
    Jet result;
    result.a = select(condition, x.a, y.a);
    for (int k = 0; k < N; ++k) result.v(k) = select(condition, x.v(k), y.v(k));
    return result;
  }
  /// Functions: the chain rule.
  /// @{
  friend Jet sqrt(const Jet& x) {
    using std::sqrt;
    const S root = sqrt(x.a);
    return {root, x.v * (S(0.5) / root)};
  }
  friend Jet abs(const Jet& x) { return select(x < Jet(S(0.0)), -x, x); }
  friend Jet sin(const Jet& x) {
    using std::cos, std::sin;
    return {sin(x.a), x.v * cos(x.a)};
  }
  friend Jet cos(const Jet& x) {
    using std::cos, std::sin;
    return {cos(x.a), x.v * S(-sin(x.a))};
  }
  friend Jet exp(const Jet& x) {
    using std::exp;
    const S value = exp(x.a);
    return {value, x.v * value};
  }
  friend Jet log(const Jet& x) {
    using std::log;
    return {log(x.a), x.v * (S(1.0) / x.a)};
  }
  friend Jet log1p(const Jet& x) {
    using std::log1p;
    return {log1p(x.a), x.v * (S(1.0) / (S(1.0) + x.a))};
  }
  friend Jet tan(const Jet& x) {
    using std::tan;
    const S value = tan(x.a);
    return {value, x.v * (S(1.0) + value * value)};
  }
  friend Jet asin(const Jet& x) {
    using std::asin, std::sqrt;
    return {asin(x.a), x.v * (S(1.0) / sqrt(S(1.0) - x.a * x.a))};
  }
  friend Jet acos(const Jet& x) {
    using std::acos, std::sqrt;
    return {acos(x.a), x.v * (S(-1.0) / sqrt(S(1.0) - x.a * x.a))};
  }
  friend Jet atan(const Jet& x) {
    using std::atan;
    return {atan(x.a), x.v * (S(1.0) / (S(1.0) + x.a * x.a))};
  }
  friend Jet cbrt(const Jet& x) {
    using std::cbrt;
    const S root = cbrt(x.a);
    return {root, x.v * (S(1.0) / (S(3.0) * root * root))};
  }
  /// x^p.
  /// @param p  a constant: integers take any x, other numbers x >= 0
  friend Jet pow(const Jet& x, double p) {
    using std::pow;
    if (p == 0.0) return Jet(S(1.0));
    return {pow(x.a, S(p)), x.v * (S(p) * pow(x.a, S(p - 1.0)))};
  }
  friend Jet hypot(const Jet& x, const Jet& y) {
    using std::hypot;
    const S length = hypot(x.a, y.a), scale = S(1.0) / length;
    return {length, x.v * (x.a * scale) + y.v * (y.a * scale)};
  }
  friend Jet atan2(const Jet& y, const Jet& x) {
    using std::atan2;
    const S scale = S(1.0) / (x.a * x.a + y.a * y.a);
    return {atan2(y.a, x.a), y.v * (x.a * scale) - x.v * (y.a * scale)};
  }
  /// @}
};

/// The number itself.
template <class S>
[[nodiscard]] S value_of(const S& x) {
  return x;
}
/// The value of a jet.
template <class S, int N>
[[nodiscard]] S value_of(const Jet<S, N>& x) {
  return x.a;
}

/// The scalar of the measurements in a residual of scalar S: S itself, or the value type of a jet.
template <class S>
using ValueOf = decltype(value_of(std::declval<const S&>()));

/// A point as three jets: variables `first`, `first` + 1 and `first` + 2.
template <class J, class S>
[[nodiscard]] Eigen::Matrix<J, 3, 1> point_jets(const Eigen::Matrix<S, 3, 1>& p, int first) {
  return {J(p.x(), first), J(p.y(), first + 1), J(p.z(), first + 2)};
}

/// (M) values of a residual.
template <class S, int M>
[[nodiscard]] auto values_of(const Eigen::Matrix<S, M, 1>& r) {
  Eigen::Matrix<ValueOf<S>, M, 1> result;
  for (int i = 0; i < M; ++i) result(i) = value_of(r(i));
  return result;
}

/// (M x Width) derivatives of a residual with respect to the variables from `first` on.
template <int Width, int M, class J>
[[nodiscard]] auto derivatives_by(const Eigen::Matrix<J, M, 1>& r, int first) {
  Eigen::Matrix<ValueOf<J>, M, Width> result;
  for (int i = 0; i < M; ++i) {
    for (int k = 0; k < Width; ++k) result(i, k) = r(i).v(first + k);
  }
  return result;
}

}  // namespace kinecal

namespace Eigen {

template <class S, int N>
struct NumTraits<kinecal::Jet<S, N>> : NumTraits<double> {
  using Real = kinecal::Jet<S, N>;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 1,
    ReadCost = 1 + N,
    AddCost = 1 + N,
    MulCost = 3 + 2 * N
  };
  static Real epsilon() { return Real(NumTraits<double>::epsilon()); }
  static Real dummy_precision() { return Real(NumTraits<double>::dummy_precision()); }
  static Real highest() { return Real(NumTraits<double>::highest()); }
  static Real lowest() { return Real(NumTraits<double>::lowest()); }
};

template <class S, int N, class Op>
struct ScalarBinaryOpTraits<kinecal::Jet<S, N>, S, Op> {
  using ReturnType = kinecal::Jet<S, N>;
};
template <class S, int N, class Op>
struct ScalarBinaryOpTraits<S, kinecal::Jet<S, N>, Op> {
  using ReturnType = kinecal::Jet<S, N>;
};
template <class S, int N, class Op>
requires kinecal::Jet<S, N>::kOfPackets struct ScalarBinaryOpTraits<kinecal::Jet<S, N>, double,
                                                                    Op> {
  using ReturnType = kinecal::Jet<S, N>;
};
template <class S, int N, class Op>
requires kinecal::Jet<S, N>::kOfPackets struct ScalarBinaryOpTraits<double, kinecal::Jet<S, N>,
                                                                    Op> {
  using ReturnType = kinecal::Jet<S, N>;
};

}  // namespace Eigen
