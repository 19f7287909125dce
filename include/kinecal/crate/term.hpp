// A term of the cost: an error block with the sensors it compares, its weight and its loss.
//
// The compiler knows the block; the term hides its type, so that one problem can hold terms of
// different blocks.  One virtual call evaluates a whole pack of samples, so hiding costs nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kinecal/crate/any_term.hpp"
#include "kinecal/crate/difference_gram.hpp"
#include "kinecal/crate/feature_gram.hpp"
#include "kinecal/crate/local_sums.hpp"
#include "kinecal/errors/difference.hpp"
#include "kinecal/errors/plane_fit.hpp"

namespace kinecal {

/// Residuals of one term in a pack of samples, and their derivatives.
template <class S>
struct PackedRows {
  /// Consecutive features on the same chains.
  struct Run {
    std::size_t features = 0;  ///< number of them
    BodyChains<2> chains{};    ///< the chain of each body
    std::size_t width = 0;     ///< number of columns: see Term::columns()
    std::size_t jacobian = 0;  ///< index in `jacobian` of its first value
  };
  std::vector<Run> runs;     ///< only the first `num_runs` are valid
  std::size_t num_runs = 0;  ///< (vectors keep their memory for the next pack)
  std::vector<S> weight;     ///< of each feature: one, or zero where it is missing
  std::vector<S> residual;   ///< of each feature, unweighted
  std::vector<S> jacobian;   ///< row-major, run after run; values after the last run are stale

  /// Begins the next run, whose memory may be used again.
  [[nodiscard]] Run& next_run() {
    if (num_runs == runs.size()) runs.emplace_back();
    runs[num_runs].features = 0;
    return runs[num_runs++];
  }
};

/// The normal equations of one term while they are summed.
template <class S>
struct TermSums {
  S twice_cost{0.0};  ///< sum of rho
  /// Sums over the columns of each combination of chains, sorted by chains.
  std::vector<std::pair<BodyChains<2>, LocalSums<S>>> by_chains;
  FeatureGram<S> gram;                ///< of the current run of features
  DifferenceGram<S> difference;       ///< the same for a block that is a difference
  std::vector<S> weights;             ///< of the current run's features, for `difference`
  std::vector<Vector3<S>> residuals;  ///< of the current run's features, for `difference`

  /// Starts new sums; memory is kept.
  void set_zero() {
    twice_cost = S(0.0);
    for (auto& [chains, local] : by_chains) local.set_zero();
  }
};

/// A term evaluated in S.
template <class S>
class Term : public AnyTerm {
 public:
  /// The term's sensors as they see a pack of samples.
  using Views = std::span<const SensorView<S>* const>;
  using AnyTerm::AnyTerm;

  /// Adds the cost of a pack of samples.  It is not finite where a residual is undefined, such as
  /// that of a point behind a camera.
  virtual void add_cost(Views views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// Adds the cost and the normal equations of a pack of samples.
  virtual void add_normal_equations(Views views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// Residuals of a pack of samples.
  /// @param derivatives  compute the Jacobian, too
  virtual void evaluate(Views views, bool derivatives, Linearization at,
                        PackedRows<S>& out) const = 0;
  /// Columns of the whole Jacobian on which features of these chains depend: local_columns().
  virtual void columns(Views views, const BodyChains<2>& chains, std::vector<int>& out) const = 0;
};

}  // namespace kinecal
