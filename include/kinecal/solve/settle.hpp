// Fixes what a fit leaves open: full turns of angles, and directions that no residual sees.
//
// If samples and priors leave directions open, the minimum is a valley floor and a solver stops
// anywhere in it.  The result is its point nearest to the start, with each parameter measured by
// its effect on the residuals.  So it does not depend on units, and an open direction never drifts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// Wraps offsets of rotating joints and rotation vectors of frames to half a turn.  An offset that
/// drives mimic joints is wrapped only if all poses stay the same.
/// @param values  of all parameters of the table, in and out
void wrap_angles(const AnyProblem& problem, const FreeSet& free, Eigen::VectorXd& values);

/// Moves a solution along undetermined directions to the point nearest to the start, then to the
/// minimum there.  The cost must stay the same (1e-9); otherwise the solution is not changed.
/// @param start   values before the fit
/// @param values  of all parameters of the table: the solution, in and out
/// @returns  the cost there
double hold_undetermined(const AnyProblem& problem, const FreeSet& free,
                         const Eigen::VectorXd& start, Eigen::VectorXd& values);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/settle.ipp"
#endif
