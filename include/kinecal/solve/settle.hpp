// What a fit does not decide: angles a full turn away, and directions that no residual sees.
//
// A minimum is a valley floor where samples and priors leave directions open, and a solver stops
// anywhere in it.  The result is the point of it nearest to the start, each parameter measured by its
// effect on the residuals, so it does not depend on units and an open direction never drifts.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// Brings offsets of rotating joints and rotation vectors of frames within half a turn; offsets of
/// joints that others mimic keep their value unless that gives the same poses.
/// @param values  of all parameters of the table, in and out
void wrap_angles(const AnyProblem& problem, const FreeSet& free, Eigen::VectorXd& values);

/// Moves a solution along what nothing determines to the point nearest to the start, and to the minimum
/// there.  The cost stays the same (1e-9); otherwise the solution stays as it is.
/// @param start   values before the fit
/// @param values  of all parameters of the table: the solution, in and out
/// @returns  the cost there
double hold_undetermined(const AnyProblem& problem, const FreeSet& free,
                         const Eigen::VectorXd& start, Eigen::VectorXd& values);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/settle.ipp"
#endif
