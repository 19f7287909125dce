// Samples that a robot with given parameters would measure without errors.
//
// Joints and known targets stay as they are.  Measurements are moved until every residual is zero,
// by the smallest change:
//
//   x <- x - J^+ r        J = dr/dx by differences, once for each group of rows
//
// x are the features with the same place in a sample; for blocks that compare planes, a common
// motion of all features of a sensor.  So any sensor and error block can be simulated: only the
// residual is needed.  evaluation/rows/error_free.hpp takes one such step in each evaluation.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// Thrown if a robot, a pose or a sensor cannot be simulated.
struct StudyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Makes a problem without samples.
using MakeProblem = std::function<std::unique_ptr<AnyProblem>()>;

/// The samples as measured without any error.
/// @param values   of all parameters of the table: the true robot
/// @param samples  poses and targets; measurements need not fit, but each point must be in front of
///                 its camera
/// @throws StudyError   with the error block and the sample, if no measurement makes a residual
///                      zero
/// @throws SampleError  if a sample does not match the problem
[[nodiscard]] std::vector<Sample> exact_samples(const MakeProblem& make, ParameterValues values,
                                                std::span<const Sample> samples);

}  // namespace kinecal
