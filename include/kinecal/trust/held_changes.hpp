// Parameters that are held and whose change would explain residuals.
//
// The rows are linearized once with more parameters than were free.  The fall of the sum of squares with a group
// of the held ones follows by linear algebra, without another solve.
// Source: Rao, Large Sample Tests of Statistical Hypotheses, 1948, the score test.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"

namespace kinecal {

/// What the change of held parameters explains.
struct HeldChange {
  double noise_left = 1.0;  ///< ratio of the noise with the change to that without; 1: no evidence
  double size = 0.0;        ///< length of the change, in the unit of its parameters
};

/// For each group of held parameters, what its change explains.
/// @param all     free parameters and held ones
/// @param values  of all parameters of the table: the solution
/// @param free    table indices of those that were free
/// @param groups  table indices of held ones, each group of one unit
[[nodiscard]] std::vector<HeldChange> held_changes(const AnyProblem& problem, const FreeSet& all,
                                                   const std::vector<double>& values,
                                                   const std::set<int>& free,
                                                   const std::vector<std::vector<int>>& groups);

}  // namespace kinecal
