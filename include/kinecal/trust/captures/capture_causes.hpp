// Why a sample does not fit the others, if the cause can be recognised.
//
// Each possible cause is undone in the sample, which is then evaluated at the values of the others.
// A cause is named if every feature then fits within the noise, and if enough residuals remain to
// test it: a single feature that is off by chance gets no cause.
//
//   order of features     two exchanged; one that is another; a board reversed or turned by a quarter.
//                         Nothing is fitted, so two features are enough.
//   one joint's reading   Gauss-Newton over its position: three features, or one with orientation
//   motion                all joints slightly, penalty (q / 0.2 rad)^2: five residuals more than
//                         unknowns.  A slipped target looks the same, so both are named.
//   slip                  of a block that looks at the sample before, one number that it compares: a wheel
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/problem/any_problem.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/trust/noise/noise.hpp"

namespace kinecal {

/// The likely cause of a bad capture: "features 1 and 2 are exchanged", "'elbow' reads 4.9 deg less
/// than the others say".  Empty if none is recognised.
/// @param problem of the fit
/// @param values  of all parameters of its table, fitted to the other samples
/// @param noise   of each error block, in their order
/// @param sample  the bad one
[[nodiscard]] std::string capture_cause(const AnyProblem& problem, ParameterValues values,
                                        const std::vector<BlockNoise>& noise, const Sample& sample);

}  // namespace kinecal
