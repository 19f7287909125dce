// Definitions of f_distribution.hpp, by Boost.Math.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/f_distribution.hpp"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <cmath>

namespace kinecal {

namespace detail {
namespace {

/// What is not defined is NaN and what is too large infinite, without exceptions.
using QuietMath = boost::math::policies::policy<
    boost::math::policies::promote_double<false>,  // long double takes 8 times as long
    boost::math::policies::domain_error<boost::math::policies::ignore_error>,
    boost::math::policies::pole_error<boost::math::policies::ignore_error>,
    boost::math::policies::overflow_error<boost::math::policies::ignore_error>,
    boost::math::policies::evaluation_error<boost::math::policies::ignore_error>,
    boost::math::policies::rounding_error<boost::math::policies::ignore_error>>;

}  // namespace
}  // namespace detail

double f_tail(double f, double a, double b) {
  if (!(f > 0.0)) return 1.0;
  if (!std::isfinite(f)) return 0.0;
  if (std::isinf(b)) {
    const boost::math::chi_squared_distribution<double, detail::QuietMath> sum(a);
    return cdf(complement(sum, a * f));
  }
  const boost::math::fisher_f_distribution<double, detail::QuietMath> ratio(a, b);
  return cdf(complement(ratio, f));
}

double f_exceeded(double a, double b, double probability) {
  const boost::math::fisher_f_distribution<double, detail::QuietMath> ratio(a, b);
  return quantile(complement(ratio, probability));
}

double chi_square_exceeded(double freedom, double probability) {
  const boost::math::chi_squared_distribution<double, detail::QuietMath> sum(freedom);
  return quantile(complement(sum, probability));
}

double noncentrality(double a, double b, double level, double power) {
  using Sum = boost::math::non_central_chi_squared_distribution<double, detail::QuietMath>;
  return Sum::find_non_centrality(a, a * f_exceeded(a, b, level), 1.0 - power);
}

}  // namespace kinecal
