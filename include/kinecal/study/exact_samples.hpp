// Samples as a robot with given parameters would measure them if nothing erred.
//
// The joints stay where they are, and so do known targets.  What was measured is moved until every
// residual is zero, by the least way:
//
//   x <- x - J^+ r        J = dr/dx by differences, once for each group of rows
//
// x are the features with one place in a sample; of blocks that compare planes, the motion of all
// features of a sensor together.  So any sensor and any error block can be simulated: nothing has to
// be known of a sensor but its residual.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// A robot, a pose or a sensor that cannot be simulated.
struct StudyError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Makes a problem without samples.
using MakeProblem = std::function<std::unique_ptr<AnyProblem>()>;

/// The samples as they are measured without any error.
/// @param values   of all parameters of the table: the true robot
/// @param samples  poses and targets; what was measured need not fit, but each point must be in front
///                 of its camera
/// @throws StudyError   with the error block and the sample, if no measurement makes a residual zero
/// @throws SampleError  if a sample does not suit the problem
[[nodiscard]] std::vector<Sample> exact_samples(const MakeProblem& make,
                                                std::span<const double> values,
                                                std::span<const Sample> samples);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/study/exact_samples.ipp"
#endif
