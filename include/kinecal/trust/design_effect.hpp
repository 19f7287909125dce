// How strongly the features of a sample err together: joints that do not repeat, a board that
// bends.
//
//   d = sum over samples of g^T (I - M)^-1 g  /  sum over features of f^T f
//
// with f the gradient of a feature, g their sum in a sample, M the sample's share of the
// information, in coordinates in which the whole information is the identity.  Independent errors
// give 1; if all n features of each sample err alike, n.  The factor I - M restores what the fit
// has taken from the residuals of an influential sample.
// Source: Kish, Survey Sampling, 1965, 8.2; Bell, McCaffrey, Bias Reduction in Standard Errors for
// Linear Regression with Multi-Stage Samples, 2002.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/solve/linear_fit.hpp"

namespace kinecal {

/// Variance of the parameters over its value for independent features.
/// @return  one, unless the samples show more by three standard deviations
[[nodiscard]] double design_effect(const AnyProblem& problem, const LinearFit& fit);

}  // namespace kinecal
