// How likely a statistic is as large by chance: the upper tail of the F distribution.
//
//   P(F > f) = I_x(b/2, a/2),  x = b / (b + a f)      I the regularized incomplete beta function
//
// for a ratio of mean squares with a and b degrees of freedom.  With b = infinity, a F is chi-square.
// Source: Press et al., Numerical Recipes, 6.4 (the continued fraction of Lentz) and 6.14.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/linkage.hpp"

namespace kinecal {

/// Probability that F is larger than f.
/// @param f  ratio of mean squares, not negative
/// @param a  degrees of freedom of the numerator, positive
/// @param b  those of the denominator, positive; beyond 1e7 it counts as infinite
[[nodiscard]] double f_tail(double f, double a, double b);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/f_distribution.ipp"
#endif
