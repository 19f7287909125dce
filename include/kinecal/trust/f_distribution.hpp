// How likely a statistic is as large by chance: the upper tails of the F and the chi-square distribution,
// by Boost.Math.
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal {

/// Probability that F, a ratio of mean squares, is larger than f.
/// @param f  ratio of mean squares, not negative
/// @param a  degrees of freedom of the numerator, positive
/// @param b  those of the denominator, positive; if infinite, a F is chi-square
[[nodiscard]] double f_tail(double f, double a, double b);

/// The F that is exceeded with a probability.
/// @param a            degrees of freedom of the numerator, positive
/// @param b            those of the denominator, positive
/// @param probability  above 0, below 1
[[nodiscard]] double f_exceeded(double a, double b, double probability);

/// The sum of `freedom` squares of unit variance that is exceeded with a probability.
/// @param freedom      degrees of freedom, positive
/// @param probability  above 0, below 1
[[nodiscard]] double chi_square_exceeded(double freedom, double probability);

}  // namespace kinecal
