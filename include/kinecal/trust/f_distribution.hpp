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

/// The sum of squares of the means of `a` normal variables of unit variance at which their mean square
/// exceeds, with probability `power`, the F that chance exceeds with probability `level`.
/// @param a, b          degrees of freedom, see f_exceeded()
/// @param level, power  above 0, below 1
[[nodiscard]] double noncentrality(double a, double b, double level, double power);

}  // namespace kinecal
