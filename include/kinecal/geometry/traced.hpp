// A traced number: a double that knows whether it depends on a variable.
//
// A jet of traced numbers finds which derivatives of a function are constant for all arguments:
//
//
//   Jet<Traced, 1> x{Traced{3.0, true}, 0};
//   (2.0 * x + 1.0).v(0)   2, constant            (x * x).v(0)   6, varies
//
// Comparing variables gives a variable mask, and so does select() with it: a piecewise function is
// not mistaken for its current piece.  Anything times the constant zero is the constant zero.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "kinecal/geometry/eigen_layout.hpp"

namespace kinecal {

/// A double that knows whether it depends on a variable.
struct Traced {
  double value = 0.0;   ///< the number
  bool varies = false;  ///< true if it depends on a variable

  Traced() = default;
  /// A constant.
  Traced(double constant) : value(constant) {}  // NOLINT: a number is a constant
  /// A constant or a variable.
  Traced(double number, bool does_vary) : value(number), varies(does_vary) {}
  explicit operator double() const { return value; }  ///< the number

  /// The result of a comparison.
  struct Mask {
    bool value;   ///< the result for these numbers
    bool varies;  ///< true if it depends on a variable

    /// a if the comparison holds, else b: see select().
    [[nodiscard]] Traced operator()(const Traced& a, const Traced& b) const {
      return {value ? a.value : b.value, varies || a.varies || b.varies};
    }
  };

  /// True for the constant zero.
  [[nodiscard]] bool is_zero() const { return !varies && value == 0.0; }

  /// Arithmetic: a result varies if an operand does.
  /// @{
  Traced operator-() const { return {-value, varies}; }
  Traced& operator+=(const Traced& y) { return *this = *this + y; }
  Traced& operator-=(const Traced& y) { return *this = *this - y; }
  Traced& operator*=(const Traced& y) { return *this = *this * y; }
  Traced& operator/=(const Traced& y) { return *this = *this / y; }

  friend Traced operator+(const Traced& x, const Traced& y) {
    return {x.value + y.value, x.varies || y.varies};
  }
  friend Traced operator-(const Traced& x, const Traced& y) {
    return {x.value - y.value, x.varies || y.varies};
  }
  friend Traced operator*(const Traced& x, const Traced& y) {
    if (x.is_zero() || y.is_zero()) return {};
    return {x.value * y.value, x.varies || y.varies};
  }
  friend Traced operator/(const Traced& x, const Traced& y) {
    if (x.is_zero()) return {};
    return {x.value / y.value, x.varies || y.varies};
  }
  /// @}

  // clang-format off
  /// Comparison of the numbers.
  /// @{
  friend Mask operator==(const Traced& x, const Traced& y) { return {x.value == y.value, x.varies || y.varies}; }
  friend Mask operator<(const Traced& x, const Traced& y) { return {x.value < y.value, x.varies || y.varies}; }
  friend Mask operator>(const Traced& x, const Traced& y) { return y < x; }
  friend Mask operator<=(const Traced& x, const Traced& y) { return {x.value <= y.value, x.varies || y.varies}; }
  friend Mask operator>=(const Traced& x, const Traced& y) { return y <= x; }
  /// @}
  // clang-format on

  /// Functions: a result varies if an argument does.
  /// @{
  friend Traced sqrt(const Traced& x) { return {std::sqrt(x.value), x.varies}; }
  friend Traced sin(const Traced& x) { return {std::sin(x.value), x.varies}; }
  friend Traced cos(const Traced& x) { return {std::cos(x.value), x.varies}; }
  friend Traced exp(const Traced& x) { return {std::exp(x.value), x.varies}; }
  friend Traced log(const Traced& x) { return {std::log(x.value), x.varies}; }
  friend Traced log1p(const Traced& x) { return {std::log1p(x.value), x.varies}; }
  friend Traced tan(const Traced& x) { return {std::tan(x.value), x.varies}; }
  friend Traced asin(const Traced& x) { return {std::asin(x.value), x.varies}; }
  friend Traced acos(const Traced& x) { return {std::acos(x.value), x.varies}; }
  friend Traced atan(const Traced& x) { return {std::atan(x.value), x.varies}; }
  friend Traced cbrt(const Traced& x) { return {std::cbrt(x.value), x.varies}; }
  friend Traced pow(const Traced& x, const Traced& p) {
    return {std::pow(x.value, p.value), x.varies || p.varies};
  }
  friend Traced hypot(const Traced& x, const Traced& y) {
    return {std::hypot(x.value, y.value), x.varies || y.varies};
  }
  friend Traced atan2(const Traced& y, const Traced& x) {
    return {std::atan2(y.value, x.value), x.varies || y.varies};
  }
  /// @}
};

}  // namespace kinecal

namespace Eigen {

template <>
struct NumTraits<kinecal::Traced> : NumTraits<double> {
  using Real = kinecal::Traced;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { RequireInitialization = 1 };
};

}  // namespace Eigen
