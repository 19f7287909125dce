// What counts as a number in the templates of geometry/ and kinematics/: double, float, packets, jets, and
// numbers of other libraries.
//
// Constants are doubles, so a scalar is multiplied by them.  An operator may return an expression: it is made a
// number at once.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <concepts>
#include <type_traits>

namespace kinecal {

namespace detail {

// Functions are found where the type is, or in std.
using std::cos, std::sin;

template <class S>
concept HasSineAndCosine = requires(const S& x) {
  S(sin(x));
  S(cos(x));
};

template <class S, class U>
struct ProductOf {
  using type = std::remove_cvref_t<decltype(std::declval<const S&>() * std::declval<const U&>())>;
};
template <class S>
struct ProductOf<S, S> {
  using type = S;
};
template <class S>
struct ProductOf<S, double> {
  using type = S;
};
template <class S>
struct ProductOf<double, S> {
  using type = S;
};
template <>
struct ProductOf<double, double> {
  using type = double;
};

}  // namespace detail

/// A scalar of forward kinematics: a number that is not whole, with arithmetic, sine and cosine.
template <class S>
concept Scalar = !std::integral<S> && std::copyable<S> && std::constructible_from<S, double> &&
                 detail::HasSineAndCosine<S> && requires(S & sum, const S& x, double constant) {
  S(x + x);
  S(x - x);
  S(x * x);
  S(-x);
  S(x * constant);
  sum += x;
};

/// The scalar of a product of two scalars: of a number and a double, that of the number.
template <class S, class U>
using Product = typename detail::ProductOf<S, U>::type;

/// a x + b y + c z.
template <class R, class S, class U>
[[nodiscard, gnu::always_inline]] inline R sum_of_products(const S& a, const U& x, const S& b,
                                                           const U& y, const S& c, const U& z) {
  if constexpr (std::same_as<decltype(a * x), R>) {
    return a * x + b * y + c * z;
  } else {
    return R(R(R(a * x) + R(b * y)) + R(c * z));  // expressions of numbers of different sizes
  }
}

}  // namespace kinecal
