// Solves a step from several starts: if a pose is unknown, and at random on request.
//
// Frames of unknown pose are first fitted alone to a few samples, from a grid of orientations
// (fit_frames.hpp).  The best few fits are then solved with everything free.  So is the configured
// start, and its minimum is taken unless another is lower by more than rounding, or as low with a frame
// that was searched for in another place.  A frame with a
// pose in the URDF or configuration takes part only if the step otherwise ends badly: it does not
// converge, rotates this frame by more than 30 degrees, or bends the robot: a joint turns by 45 degrees, or moves
// by 0.1 m.  Of minima that are alike within noise, the one that bends the robot less is taken.
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

/// Minimizes the cost of a problem from several starts; StepResult::starts describes them.
/// @param values   of all parameters of the problem's table: in: where to start; out: where it
///                 ended.  Unchanged if no result is usable
/// @param options  also uses its random_starts
/// @param unknown  frames of unknown pose; those that only translate are fitted with the others
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
