// Solving a step from several starts: where a pose is unknown, and at random on request.
//
// Frames whose pose nobody gave are fitted alone, from a grid of orientations, to a few samples
// (fit_frames.hpp), and the best few fits are solved with everything free.  So is the start that the
// configuration gives, and its minimum is taken unless another is lower by more than rounding.  A
// frame with a pose in the URDF or in the configuration takes part only if the step ends badly without:
// it does not converge, or it turns this frame by more than 30 degrees.
//
// The result does not depend on the number of threads.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/fit_frames.hpp"
#include "kinecal/solve/solve.hpp"

namespace kinecal {

/// Minimizes the cost of a problem from several starts.  StepResult::starts says what was done.
/// @param values   of all parameters of the problem's table: in: where to start; out: where it
///                 ended.  Unchanged if no result is usable
/// @param options  its random_starts are added
/// @param unknown  frames whose pose is not known; those that only shift are fitted with the others
/// @param excerpt  the problem with a few of its samples; null: the problem itself
/// @throws std::invalid_argument  as solve()
[[nodiscard]] StepResult solve_from_starts(const AnyProblem& problem, const FreeSet& free,
                                           Eigen::VectorXd& values, const SolveOptions& options,
                                           std::span<const UnknownFrame> unknown,
                                           const AnyProblem* excerpt = nullptr);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/starts.ipp"
#endif
