// A term's functions in the scalar S, behind one interface, so that one problem can hold terms of
// different blocks.  One virtual call evaluates a whole batch, so the interface costs nothing.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "kinecal/evaluation/feature_wrenches.hpp"
#include "kinecal/evaluation/local_sums.hpp"
#include "kinecal/evaluation/point_wrenches.hpp"

namespace kinecal::detail {

/// Residuals of one term in a batch of samples, and their derivatives.
template <class S>
struct BatchRows {
  std::vector<S> weight;    ///< of each feature: one, or zero where it is missing
  std::vector<S> factor;    ///< of each feature: see TermResiduals; empty: all are one
  std::vector<S> residual;  ///< of each feature, unweighted
  std::vector<S> jacobian;  ///< of each feature, column-major; values after the last one are stale

  /// The rows of one lane; skips features that are missing in it.
  /// @param columns  of the whole Jacobian; negative: residuals only
  void unpack(std::span<const FeatureRun> runs, int feature_size, int lane_index, int columns,
              TermResiduals& out) const {
    Eigen::Index present = 0;
    for (const S& w : weight) present += lane(w, lane_index) > 0.0 ? 1 : 0;
    out.resize(present * feature_size, columns);
    Eigen::Index row = 0;
    const auto size = static_cast<std::size_t>(feature_size);
    std::size_t value = 0;
    for (const FeatureRun& run : runs) {
      for (std::size_t feature = run.first; feature < run.end; ++feature) {
        const bool there = lane(weight[feature], lane_index) > 0.0;
        for (int m = 0; there && m < feature_size; ++m) {
          out.residual(row + m) = lane(residual[feature * size + std::size_t(m)], lane_index);
          if (!factor.empty()) out.factor(row + m) = lane(factor[feature], lane_index);
        }
        if (columns >= 0) {
          for (const int column : run.columns) {
            for (int m = 0; m < feature_size; ++m) {
              const double derivative = lane(jacobian[value++], lane_index);
              if (there) out.jacobian(row + m, column) += derivative;
            }
          }
        }
        if (there) row += feature_size;
      }
    }
  }
};

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

/// The functions of a term in the scalar S.
template <class S>
class TermCode {
 public:
  using Views = TermViews<S>;  ///< the term, its sensors in a batch, and its parameters

  virtual ~TermCode() = default;

  /// Adds the cost of a batch of samples.  It is not finite if a residual is undefined, such as
  /// that of a point behind a camera.
  virtual void add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const = 0;
  /// Adds the cost and the normal equations of a batch of samples.
  virtual void add_normal_equations(const Views& views, const Loss& loss,
                                    TermSums<S>& sums) const = 0;
  /// Residuals of a batch of samples.
  /// @param derivatives  compute the Jacobian, too
  virtual void evaluate(const Views& views, bool derivatives, Linearization at,
                        BatchRows<S>& out) const = 0;
};

}  // namespace kinecal::detail
