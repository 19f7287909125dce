// How many independent numbers the samples measure of a robot.
//
//   numbers = sum over samples and error blocks of min(residuals, 6)
//
// A camera may see any number of corners of a board; together they give the pose of one body: six
// numbers.  Errors of joints and links are in these six.  Further residuals only average the
// camera's noise, and samples with fewer numbers than free parameters fit any parameters.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// The numbers that the samples of a problem measure.
/// @param values  of all parameters of the table
[[nodiscard]] int measured_numbers(const AnyProblem& problem, ParameterValues values);

}  // namespace kinecal
