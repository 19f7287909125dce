// The normal equations of one term, with the memory for one batch.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "kinecal/evaluation/sums/feature_wrenches.hpp"
#include "kinecal/evaluation/sums/local_sums.hpp"
#include "kinecal/evaluation/sums/point_wrenches.hpp"

namespace kinecal::detail {

/// The normal equations of one term, summed lane by lane, with the memory for one batch.
template <class S>
struct TermSums {
  S twice_cost{0.0};  ///< sum of rho
  /// Sums for each combination of chains, sorted by chains.
  std::vector<std::pair<BodyChains, LocalSums<S>>> by_chains;
  FeatureWrenches<S> wrenches;        ///< of the current run of features
  PointWrenches<S> point_wrenches;    ///< the same for a block that only subtracts points
  std::vector<S> weights;             ///< of the current run's features, for `point_wrenches`
  std::vector<Vector3<S>> residuals;  ///< of the current run's features, for `point_wrenches`

  /// Starts new sums; memory is kept.
  void set_zero() {
    twice_cost = S(0.0);
    for (auto& [chains, local] : by_chains) local.set_zero();
  }
};

}  // namespace kinecal::detail
