// Samples in succession that err alike: poses on a path, a tracker that drifts, a robot that warms up.
//
// The residual of pose p is the mean m_p of its features, less that of all poses.  Its correlation with that of the next pose is
//
//   rho = sum m_p . m_p+1 / sum |m_p|^2            by chance 0 +- 1 / sqrt(N k), k components
//
// If it is not by chance, L = (1 + rho) / (1 - rho) consecutive poses count as one: the variance of a mean of
// a first-order autoregressive series is L times that of independent values.
// Source: Bartlett, Some Aspects of the Time-Correlation Problem, 1935.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// How alike the residuals of consecutive poses are.
struct Neighbours {
  double correlation = 0.0;  ///< of their residuals; 0: what there is may be chance
  int together = 1;          ///< consecutive poses that count as one
};

/// Measures it.
/// @param poses  of the problem's samples, which are in the order of recording
[[nodiscard]] Neighbours neighbours(const AnyProblem& problem, const LinearFit& fit,
                                    const PoseGroups& poses);

/// Groups of consecutive poses.
[[nodiscard]] PoseGroups joined(const PoseGroups& poses, int together);

}  // namespace kinecal
