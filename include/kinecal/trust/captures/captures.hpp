// Bad captures: samples that do not belong to the fit of the others.
//
// The distance d of a feature is compared with the noise s of its error block:
//
//   d^2 / (s^2 (1 - h))  for samples in the fit,   d^2 / (s^2 (1 + h))  for others,   h the leverage
//
// which is k F, F of the F distribution with k and 0.37 (rows - parameters) degrees of freedom: 0.37 is the
// efficiency of the median, from which s comes.  A sample is bad if one of its features exceeds what
// happens by chance in 1 of 1000 data sets, and the sigma that was stated for its error block.  The fit is first found robustly (least trimmed squares, then
// M-estimates by Tukey), then by least squares without the bad samples, until the set is stable.  The
// result does not depend on the order of samples.
// Source: Rousseeuw, Leroy, Robust Regression and Outlier Detection, 1987; Yohai, High Breakdown-Point and
// High Efficiency Robust Estimates for Regression, 1987.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// The worst feature of a sample.
struct CaptureError {
  int sample = 0;             ///< by number in the problem
  int term = 0;               ///< error block, by number in the problem
  FeatureLabel feature = {};  ///< which one it is
  double distance = 0.0;      ///< from the fit without bad samples, unit of the residual
  double others = 0.0;        ///< largest distance of the sample's other features of the block
  double times = 0.0;         ///< distance in standard deviations of the noise
  double limit = 0.0;         ///< of `times`; beyond it a feature is bad
  bool bad = false;           ///< beyond the limit
  double influence = 0.0;  ///< shift of the parameters without the sample: sqrt(dz^T H dz / size),
                           ///< 1: as large as their own uncertainty
  double least = 0.0;      ///< smallest distance of all features of the sample and block
};

/// The worst feature of each sample, by number of the sample.
/// @param fit  of all samples, at its solution
/// @param poses  of its samples: readings of a pose err together
[[nodiscard]] std::vector<CaptureError> capture_errors(const AnyProblem& problem,
                                                       const LinearFit& fit,
                                                       const PoseGroups& poses);

}  // namespace kinecal
