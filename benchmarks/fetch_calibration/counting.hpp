// A number that counts operations: used instead of double in our templates, it counts their
// floating-point operations.
//
//   const Operations done = operations_of([&] { walk(chain, motions, corrections, walker); });
//
// An addition, subtraction, multiplication, division or square root counts one; changes of sign,
// comparisons, sines and cosines count zero.  A product with a constant counts, even with one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <concepts>
#include <limits>
#include <utility>

namespace kinecal::bench {

struct Operations {
  long additions = 0, products = 0, divisions = 0, roots = 0;

  [[nodiscard]] long total() const { return additions + products + divisions + roots; }
};

inline Operations counted;  ///< since it was last set to zero; for one thread

struct Counting {
  double value = 0.0;

  Counting() = default;
  Counting(double x) : value(x) {}  // NOLINT: a constant without operations
  template <std::integral I>
  Counting(I x) : value(static_cast<double>(x)) {}  // NOLINT
  explicit operator double() const { return value; }

  Counting operator-() const { return -value; }
  Counting& operator+=(Counting y) { return *this = *this + y; }
  Counting& operator-=(Counting y) { return *this = *this - y; }
  Counting& operator*=(Counting y) { return *this = *this * y; }
  Counting& operator/=(Counting y) { return *this = *this / y; }

  friend Counting operator+(Counting x, Counting y) {
    ++counted.additions;
    return x.value + y.value;
  }
  friend Counting operator-(Counting x, Counting y) {
    ++counted.additions;
    return x.value - y.value;
  }
  friend Counting operator*(Counting x, Counting y) {
    ++counted.products;
    return x.value * y.value;
  }
  friend Counting operator/(Counting x, Counting y) {
    ++counted.divisions;
    return x.value / y.value;
  }

  friend bool operator==(Counting x, Counting y) { return x.value == y.value; }
  friend auto operator<=>(Counting x, Counting y) { return x.value <=> y.value; }

  friend Counting sqrt(Counting x) {
    ++counted.roots;
    return std::sqrt(x.value);
  }
  friend Counting abs(Counting x) { return std::abs(x.value); }
  friend Counting sin(Counting x) { return std::sin(x.value); }
  friend Counting cos(Counting x) { return std::cos(x.value); }
  friend Counting exp(Counting x) { return std::exp(x.value); }
  friend Counting log(Counting x) { return std::log(x.value); }
  friend Counting log1p(Counting x) { return std::log1p(x.value); }
  friend Counting atan2(Counting y, Counting x) { return std::atan2(y.value, x.value); }
  friend bool isfinite(Counting x) { return std::isfinite(x.value); }
};

/// The operations of a callable on counting numbers.
template <class Work>
[[nodiscard]] Operations operations_of(Work&& work) {
  const Operations before = std::exchange(counted, {});
  work();
  return std::exchange(counted, before);
}

}  // namespace kinecal::bench

template <>
struct std::numeric_limits<kinecal::bench::Counting> : std::numeric_limits<double> {};

namespace Eigen {

template <>
struct NumTraits<kinecal::bench::Counting> : NumTraits<double> {
  using Real = kinecal::bench::Counting;
  using NonInteger = Real;
  using Nested = Real;
  using Literal = Real;
  enum { RequireInitialization = 1 };
};

template <class Op>
struct ScalarBinaryOpTraits<kinecal::bench::Counting, double, Op> {
  using ReturnType = kinecal::bench::Counting;
};
template <class Op>
struct ScalarBinaryOpTraits<double, kinecal::bench::Counting, Op> {
  using ReturnType = kinecal::bench::Counting;
};

}  // namespace Eigen
