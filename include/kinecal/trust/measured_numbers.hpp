// How many independent numbers samples measure of a robot.
//
//   numbers = sum over samples and error blocks of min(residuals, 6)
//
// However many corners a camera sees of a board, they show where one body is: six numbers.  The errors of
// joints and links are in these six, so residuals beyond them average the noise of the camera only, and
// samples with fewer numbers than free parameters fit whatever the parameters are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// The numbers that the samples of a problem measure.
/// @param values  of all parameters of the table
[[nodiscard]] int measured_numbers(const AnyProblem& problem, std::span<const double> values);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/measured_numbers.ipp"
#endif
