// A traced number: it knows whether it depends on anything that varies.
//
// In place of double in a jet it tells which derivatives of a function are constants, whatever the
// function is given:
//
//   Jet<Traced, 1> x{Traced{3.0, true}, 0};
//   (2.0 * x + 1.0).v(0)   2, constant            (x * x).v(0)   6, varies
//
// A comparison of what varies varies, too, and with it what select() chooses: a function in pieces
// is not taken for the piece that it happens to be on.  A product with a constant zero is zero.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>

namespace kinecal {

struct Traced {
  double value = 0.0;
  bool varies = false;

  Traced() = default;
  Traced(double constant) : value(constant) {}  // NOLINT: a number is a constant
  Traced(double number, bool does_vary) : value(number), varies(does_vary) {}
  explicit operator double() const { return value; }

  /// The answer to a comparison; as a function, it chooses.
  struct Mask {
    bool value, varies;

    [[nodiscard]] Traced operator()(const Traced& a, const Traced& b) const {
      return {value ? a.value : b.value, varies || a.varies || b.varies};
    }
  };

  [[nodiscard]] bool is_zero() const { return !varies && value == 0.0; }

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

  // clang-format off
  friend Mask operator==(const Traced& x, const Traced& y) { return {x.value == y.value, x.varies || y.varies}; }
  friend Mask operator<(const Traced& x, const Traced& y) { return {x.value < y.value, x.varies || y.varies}; }
  friend Mask operator>(const Traced& x, const Traced& y) { return y < x; }
  friend Mask operator<=(const Traced& x, const Traced& y) { return {x.value <= y.value, x.varies || y.varies}; }
  friend Mask operator>=(const Traced& x, const Traced& y) { return y <= x; }
  // clang-format on

  friend Traced sqrt(const Traced& x) { return {std::sqrt(x.value), x.varies}; }
  friend Traced sin(const Traced& x) { return {std::sin(x.value), x.varies}; }
  friend Traced cos(const Traced& x) { return {std::cos(x.value), x.varies}; }
  friend Traced exp(const Traced& x) { return {std::exp(x.value), x.varies}; }
  friend Traced log(const Traced& x) { return {std::log(x.value), x.varies}; }
  friend Traced atan2(const Traced& y, const Traced& x) {
    return {std::atan2(y.value, x.value), x.varies || y.varies};
  }
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
