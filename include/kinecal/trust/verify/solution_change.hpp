// Two solutions of the same parameters from different samples: have the parameters changed in between?
//
// If not, their difference d has the covariances of both, so
//
//   X = d^T (C + C')^-1 d
//
// is chi-square with as many degrees of freedom as there are parameters; C and C' are estimates, so X / freedom is compared
// with F.  The same for the parameters of one joint, frame or sensor says which have changed.
//
// drift.hpp needs no second solution and says what else may have moved; but its residuals must keep their meaning at other
// values.  Points of the robot's surface do not: they are the nearest ones at each values.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/trust/verify/drift.hpp"

namespace kinecal {

/// The change of the parameters of a joint, frame or sensor.
struct OwnerChange {
  std::string owner = {};              ///< "camera_joint"
  std::vector<int> parameters = {};    ///< table indices
  std::vector<double> change = {};     ///< of each
  std::vector<double> deviation = {};  ///< standard deviation of each change
  double statistic = 0.0;              ///< X of these parameters alone
  double probability = 1.0;            ///< of a larger one by chance
};

/// Whether two solutions agree.
struct SolutionChange {
  double statistic = 0.0;           ///< X
  int freedom = 0;                  ///< number of parameters that both determine
  double probability = 1.0;         ///< of a larger X by chance
  std::vector<OwnerChange> owners;  ///< the least probable first
};

/// Compares two solutions.
/// @param problem          with the table of both
/// @param samples_freedom  of the covariances: number of poses of both, less one each
[[nodiscard]] SolutionChange solution_change(const AnyProblem& problem, const CalibratedState& then,
                                             const CalibratedState& now, double samples_freedom);

}  // namespace kinecal
