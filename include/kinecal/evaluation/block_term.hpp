// The term of one error block: its cost, residuals, Jacobian and normal equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/errors/difference.hpp"
#include "kinecal/evaluation/rows/block_rows.hpp"
#include "kinecal/evaluation/term_code.hpp"

namespace kinecal::detail {

/// The term of an error block, for any number of columns.  Functions that are expensive to compile
/// are defined outside the class, not inline, so the library compiles them once.
template <ErrorBlock B, class S>
class BlockTerm final : public TermCode<S> {
 public:
  using typename TermCode<S>::Views;

  explicit BlockTerm(B block)
      : block_(std::move(block)), is_difference_(kinecal::is_difference(block_)) {}

  void add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const override;
  void add_normal_equations(const Views& views, const Loss& loss, TermSums<S>& sums) const override;
  void evaluate(const Views& views, bool derivatives, Linearization at,
                BatchRows<S>& out) const override;

 private:
  using Block = BlockRows<B, S>;  ///< computes rows of one feature
  static constexpr int kSize = Block::kSize;
  static constexpr std::size_t kBodies = Block::kBodies;
  using Twists = std::array<const ChainTwists<S>*, kBodies>;  ///< of the columns of each sensor

  /// True if the residual may be the difference of two points, which sums faster.
  static constexpr bool kMayBeDifference = PointPairBlock<B> && kSize == 3 && kTakesFeaturesOnly<B>;
  using Rows = typename Block::Rows;

  [[nodiscard]] static auto difference_sides(const Views& views, const FeatureRun& run,
                                             const Twists& twists) {
    std::array<DifferenceSide<S>, kBodies> sides;
    for (std::size_t s = 0; s < kBodies; ++s) {
      sides[s] = {views[s].values(run.first), views[s].changes(run.first),
                  views[s].own().free.size(), twists[s]};
    }
    return sides;
  }

  /// Adds the features of a run by their moments.
  /// @returns  false, without adding anything, if the block is not a difference
  bool add_difference(const Views& views, const FeatureRun& run, const Twists& twists,
                      const Loss& loss, TermSums<S>& sums) const {
    if constexpr (kMayBeDifference) {
      if (!is_difference_) return false;
      const std::size_t features = run.end - run.first;
      const auto sides = difference_sides(views, run, twists);
      sums.weights.resize(features);
      sums.residuals.resize(features);
      for (std::size_t i = 0; i < features; ++i) {
        sums.residuals[i] = block_(sides[0].points[i], sides[1].points[i]);
        const S present = Block::present(views, run.first + i);
        sums.weights[i] = add_cost(views, run.first + i, sums.residuals[i], present, loss, sums);
      }
      sums.point_wrenches.set(sides, sums.weights, sums.residuals);
      sums_of(run, sums).add(sums.point_wrenches);
    }
    return kMayBeDifference;
  }

  /// The block's sigma over the feature's own; one where the feature has none.
  [[nodiscard]] static S factor_of(const S& inverse_sigma, double sigma) {
    return select(inverse_sigma == S(0.0), S(1.0), inverse_sigma * S(sigma));
  }

  /// Adds the cost of a feature.
  /// @returns  the feature's weight in the normal equations
  S add_cost(const Views& views, std::size_t i, const Eigen::Matrix<S, kSize, 1>& residual,
             const S& present, const Loss& loss, TermSums<S>& sums) const {
    S w2(views.term->weight * views.term->weight);
    if (const S* inverse_sigmas = views.inverse_sigmas) {
      const S factor = factor_of(inverse_sigmas[i], views.term->sigma);
      w2 *= factor * factor;
    }
    S squared(0.0);
    for (int m = 0; m < kSize; ++m) squared += residual(m) * residual(m);
    squared *= w2;
    const auto value = loss(squared);
    sums.twice_cost += present * value.rho + S(0.0) * squared;  // NaN where infinite
    return present * w2 * value.derivative;
  }

  [[nodiscard]] static Twists twists(const Views& views, const BodyChains& chains) {
    Twists result;
    for (std::size_t s = 0; s < kBodies; ++s) result[s] = &views[s].twists(chains[s]);
    return result;
  }

  [[nodiscard]] static LocalSums<S>& sums_of(const FeatureRun& run, TermSums<S>& sums) {
    // Sorted by chains, so that sums are added in the same order whichever chains came first.
    const auto place = std::find_if(sums.by_chains.begin(), sums.by_chains.end(),
                                    [&](const auto& known) { return !(known.first < run.chains); });
    if (place != sums.by_chains.end() && place->first == run.chains) return place->second;
    return sums.by_chains.emplace(place, run.chains, LocalSums<S>(run.columns))->second;
  }

  /// Residuals and Jacobian of a run of features.
  /// @param jacobian  (kSize x columns) of each feature, column-major, out
  KINECAL_FLATTEN void write_run(const Views& views, const FeatureRun& run, Linearization at,
                                 const Twists& twists, BatchRows<S>& out, S* jacobian) const {
    Rows rows;
    for (std::size_t i = run.first; i < run.end; ++i, jacobian += kSize * run.columns.size()) {
      Block::template rows<true>(block_, views, i, at, rows);
      store(i, rows.residual, rows.present, out);
      write_columns(rows, twists, jacobian);
    }
  }

  /// The same for a block that only subtracts its points.
  KINECAL_FLATTEN void write_difference(const Views& views, const FeatureRun& run,
                                        const Twists& twists, BatchRows<S>& out,
                                        S* jacobian) const {
    if constexpr (kMayBeDifference) {
      const auto sides = difference_sides(views, run, twists);
      const std::size_t features = run.end - run.first, columns = run.columns.size();
      for (std::size_t k = 0; k < features; ++k) {
        store(run.first + k, block_(sides[0].points[k], sides[1].points[k]),
              Block::present(views, run.first + k), out);
      }
      std::size_t k = 0;
      constexpr std::size_t kAtOnce = kLanes<S> == 1 ? 1 : 4;
      for (; k + kAtOnce <= features; k += kAtOnce, jacobian += kAtOnce * 3 * columns) {
        write_differences<kAtOnce>(sides, k, columns, jacobian);
      }
      for (; k < features; ++k, jacobian += 3 * columns) {
        write_differences<1>(sides, k, columns, jacobian);
      }
    }
  }

  static void store(std::size_t i, const Eigen::Matrix<S, kSize, 1>& residual, const S& present,
                    BatchRows<S>& out) {
    out.present[i] = present;
    for (int m = 0; m < kSize; ++m) out.residual[i * kSize + std::size_t(m)] = residual(m);
  }

  B block_;
  bool is_difference_;
};

template <ErrorBlock B, class S>
void BlockTerm<B, S>::add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const {
  Rows rows;
  for (std::size_t i = 0; i < views.features(); ++i) {
    Block::template rows<false>(block_, views, i, Linearization::measured, rows);
    (void)add_cost(views, i, rows.residual, rows.present, loss, sums);
  }
}

template <ErrorBlock B, class S>
void BlockTerm<B, S>::add_normal_equations(const Views& views, const Loss& loss,
                                           TermSums<S>& sums) const {
  for (const FeatureRun& run : views.runs) {
    const Twists of_run = twists(views, run.chains);
    if (add_difference(views, run, of_run, loss, sums)) continue;
    sums.wrenches.start(of_run, views.num_own());
    Rows rows;
    for (std::size_t i = run.first; i < run.end; ++i) {
      Block::template rows<true>(block_, views, i, Linearization::measured, rows);
      sums.wrenches.add(rows, add_cost(views, i, rows.residual, rows.present, loss, sums));
    }
    sums.wrenches.finish();
    sums_of(run, sums).add(sums.wrenches);
  }
}

template <ErrorBlock B, class S>
void BlockTerm<B, S>::evaluate(const Views& views, bool derivatives, Linearization at,
                               BatchRows<S>& out) const {
  const std::size_t features = views.features();
  out.present.resize(features);
  out.residual.resize(features * kSize);
  out.factor.clear();
  if (const S* inverse_sigmas = views.inverse_sigmas) {
    for (std::size_t i = 0; i < features; ++i) {
      out.factor.push_back(factor_of(inverse_sigmas[i], views.term->sigma));
    }
  }
  if (!derivatives) {
    Rows rows;
    for (std::size_t i = 0; i < features; ++i) {
      Block::template rows<false>(block_, views, i, at, rows);
      store(i, rows.residual, rows.present, out);
    }
    return;
  }
  std::size_t values = 0;
  for (const FeatureRun& run : views.runs) {
    values += (run.end - run.first) * kSize * run.columns.size();
  }
  if (out.jacobian.size() < values) out.jacobian.resize(values);
  S* jacobian = out.jacobian.data();
  for (const FeatureRun& run : views.runs) {
    const Twists of_run = twists(views, run.chains);
    if (is_difference_ && at == Linearization::measured) {
      write_difference(views, run, of_run, out, jacobian);
    } else {
      write_run(views, run, at, of_run, out, jacobian);
    }
    jacobian += (run.end - run.first) * kSize * run.columns.size();
  }
}

}  // namespace kinecal::detail
