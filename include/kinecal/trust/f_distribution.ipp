// Computing tails of the F distribution.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

#include "kinecal/trust/f_distribution.hpp"

namespace kinecal {

namespace detail {

/// The continued fraction of the incomplete beta function.
[[nodiscard]] inline double beta_fraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300, kPrecision = 1e-14;
  constexpr int kTerms = 100000;
  const auto not_zero = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1.0, d = 1.0 / not_zero(1.0 - (a + b) * x / (a + 1.0)), value = d;
  for (int m = 1; m < kTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    double factor = 1.0;
    for (const double term : {even, odd}) {
      d = 1.0 / not_zero(1.0 + term * d);
      c = not_zero(1.0 + term / c);
      factor = c * d;
      value *= factor;
    }
    if (std::abs(factor - 1.0) < kPrecision) break;
  }
  return value;
}

/// I_x(a, b), with 1 - x given as well: it may be too small for the difference.
[[nodiscard]] inline double incomplete_beta(double a, double b, double x, double rest) {
  if (x <= 0.0) return 0.0;
  if (rest <= 0.0) return 1.0;
  const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                a * std::log(x) + b * std::log(rest));
  return x < (a + 1.0) / (a + b + 2.0) ? front * beta_fraction(a, b, x) / a
                                       : 1.0 - front * beta_fraction(b, a, rest) / b;
}

}  // namespace detail

KINECAL_INLINE double f_tail(double f, double a, double b) {
  if (!(f > 0.0)) return 1.0;
  if (!std::isfinite(f)) return 0.0;
  constexpr double kInfinite = 1e7;
  const double of = std::min(b, kInfinite), sum = of + a * f;
  return std::clamp(detail::incomplete_beta(0.5 * of, 0.5 * a, of / sum, a * f / sum), 0.0, 1.0);
}

}  // namespace kinecal
