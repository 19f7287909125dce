// The term of one error block: its cost, residuals, Jacobian and normal equations.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/evaluation/block_rows.hpp"
#include "kinecal/evaluation/jacobian_rows.hpp"
#include "kinecal/evaluation/term.hpp"

namespace kinecal {

/// The term of an error block, for any number of columns.  Functions that are expensive to compile
/// are defined outside of the class: they are not inline, so instances.hpp can compile them once.
template <ErrorBlock B, class S>
class BlockTerm : public Term<S> {
 public:
  static constexpr int kSize = kResiduals<B>;  ///< residuals of one feature
  /// The term's sensors as they see a batch of samples.
  using typename Term<S>::Views;
  /// What the sensors of the term observed in one sample.
  using Observations = AnyTerm::Observations;

  /// @param sensors     indices of the sensors in the problem
  /// @param parameters  table indices of the block's own parameters
  BlockTerm(std::string name, B block, std::vector<int> sensors, std::vector<int> parameters,
            TermOptions options)
      : Term<S>(std::move(name), std::move(sensors), std::move(parameters), std::move(options)),
        block_(std::move(block)),
        is_difference_(kinecal::is_difference(block_)) {}

  [[nodiscard]] int feature_size() const override { return kSize; }

  [[nodiscard]] std::span<const Quantity> quantities() const override { return kQuantities<B>; }

  [[nodiscard]] std::span<const std::string_view> conditions() const override {
    return kConditionsOfBlock<B>;
  }

  [[nodiscard]] bool pairs_features() const override { return !PlanePairBlock<B>; }

  [[nodiscard]] int count(Observations seen) const override;

  void add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const override;

  void add_normal_equations(const Views& views, const Loss& loss, TermSums<S>& sums) const override;

  void evaluate(const Views& views, bool derivatives, Linearization at,
                BatchRows<S>& out) const override;

 protected:
  using Block = BlockRows<B, S>;                          ///< computes rows of one feature
  static constexpr std::size_t kBodies = Block::kBodies;  ///< number of sensors
  using Twists = std::array<BodyTwists<S>, kBodies>;      ///< of the columns of each sensor

  /// Whether the residual may be the difference of two points, which is summed faster.
  static constexpr bool kMayBeDifference =
      PointPairBlock<B> && kSize == 3 && detail::kTakesFeaturesOnly<B>;

  /// Residuals and Jacobian of the features from `first` to `end`; the block is a difference.
  /// @param sizes     how many columns each body has
  /// @param jacobian  (kSize features x columns) where its rows go
  KINECAL_FLATTEN virtual void write_differences(const Views& views, std::size_t first,
                                                 std::size_t end, const Twists& twists,
                                                 const std::array<BodySizes, kBodies>& sizes,
                                                 BatchRows<S>& out, S* jacobian) const;

  /// Stores the residual of a feature, given the two points: see write_differences().
  [[nodiscard]] auto residuals_to(const Views& views, BatchRows<S>& out) const {
    return [this, &views, &out](std::size_t i, const auto& a, const auto& b) {
      store(i, block_(a, b), Block::weight(views, i), out);
    };
  }

 private:
  using Rows = typename Block::Rows;

  /// Adds the features from `first` to `end` by their moments.
  /// @returns  false, without adding anything, if the block is not a difference
  bool add_difference(const Views& views, std::size_t first, std::size_t end, const Loss& loss,
                      TermSums<S>& sums) const {
    if constexpr (kMayBeDifference) {
      if (!is_difference_) return false;
      const BodyChains chains = Block::chains(views, first);
      const Twists of_run = twists(views, chains);
      typename PointWrenches<S>::Sides sides;
      for (std::size_t s = 0; s < 2; ++s) {
        const std::size_t own = views[s].own().free.size();
        sides[s] = {{views[s].values(first), end - first},
                    {views[s].changes(first), own * (end - first)},
                    own,
                    of_run[s]};
      }
      sums.weights.resize(end - first);
      sums.residuals.resize(end - first);
      for (std::size_t i = 0; i < end - first; ++i) {
        sums.residuals[i] = block_(sides[0].points[i], sides[1].points[i]);
        const S weight = Block::weight(views, first + i);
        sums.weights[i] = add_cost(views, first + i, sums.residuals[i], weight, loss, sums);
      }
      sums.point_wrenches.set(sides, sums.weights, sums.residuals);
      sums_of(views, chains, sums).add(sums.point_wrenches);
    }
    return kMayBeDifference;
  }

  /// The first feature after `first` on other chains.
  [[nodiscard]] static std::size_t end_of_run(const Views& views, std::size_t first) {
    std::size_t end = Block::features(views);
    for (std::size_t s = 0; s < kBodies; ++s) {
      const std::vector<std::size_t>& chain = views[s].observation().layout->chain;
      std::size_t same = first + 1;
      while (same < end && chain[same] == chain[first]) ++same;
      end = same;
    }
    return end;
  }

  /// Number of columns on which features of these chains depend.
  [[nodiscard]] static std::array<BodySizes, kBodies> sizes_of(const Views& views,
                                                               const BodyChains& chains) {
    std::array<BodySizes, kBodies> sizes;
    for (std::size_t s = 0; s < kBodies; ++s) {
      const SensorState& state = views[s].state();
      const TwistColumns& twists = state.twist_columns[chains[s]];
      sizes[s] = {twists.rotational.size(), twists.translational.size(), state.own.free.size()};
    }
    return sizes;
  }

  /// Adds the cost of a feature.
  /// @returns  the feature's weight in the normal equations
  S add_cost(const Views& views, std::size_t i, const Eigen::Matrix<S, kSize, 1>& residual,
             const S& weight, const Loss& loss, TermSums<S>& sums) const {
    S w2(this->options().weight * this->options().weight);
    if (const S* factors = views.numbers.factors) w2 *= factors[i] * factors[i];
    S squared(0.0);
    for (int m = 0; m < kSize; ++m) squared += residual(m) * residual(m);
    squared *= w2;
    const auto value = loss(squared);
    sums.twice_cost += weight * value.rho + S(0.0) * squared;  // NaN where infinite
    return weight * w2 * value.derivative;
  }

  [[nodiscard]] static Twists twists(const Views& views, const BodyChains& chains) {
    Twists result;
    for (std::size_t s = 0; s < kBodies; ++s) {
      result[s] = BodyTwists<S>(views[s].twists(chains[s]));
    }
    return result;
  }

  [[nodiscard]] static LocalSums<S>& sums_of(const Views& views, const BodyChains& chains,
                                             TermSums<S>& sums) {
    // Sorted by chains, so that sums are added in the same order whichever chains came first.
    const auto place = std::find_if(sums.by_chains.begin(), sums.by_chains.end(),
                                    [&](const auto& known) { return !(known.first < chains); });
    if (place != sums.by_chains.end() && place->first == chains) return place->second;
    return sums.by_chains.emplace(place, chains, LocalSums<S>(views.sum_columns(chains)))->second;
  }

  /// Residual and Jacobian of a feature.
  /// @param jacobian  (kSize x width), row-major, out
  KINECAL_FLATTEN void write_feature(const Views& views, std::size_t i, Linearization at,
                                     const Twists& twists, BatchRows<S>& out, S* jacobian,
                                     std::size_t width) const {
    Rows rows;
    Block::template rows<true>(block_, views, i, at, rows);
    store(i, rows.residual, rows.weight, out);
    write_rows(rows, twists, jacobian, width);
  }

  static void store(std::size_t i, const Eigen::Matrix<S, kSize, 1>& residual, const S& weight,
                    BatchRows<S>& out) {
    out.weight[i] = weight;
    for (int m = 0; m < kSize; ++m) out.residual[i * kSize + std::size_t(m)] = residual(m);
  }

  B block_;
  bool is_difference_;
};

template <ErrorBlock B, class S>
int BlockTerm<B, S>::count(Observations seen) const {
  if constexpr (PlanePairBlock<B>) return 1;
  int n = 0;
  for (std::size_t i = 0; i < seen[0]->usable.size(); ++i) {
    n += std::all_of(seen.begin(), seen.end(), [i](auto* o) { return o->usable[i] > 0.0; });
  }
  return n;
}

template <ErrorBlock B, class S>
void BlockTerm<B, S>::add_cost(const Views& views, const Loss& loss, TermSums<S>& sums) const {
  Rows rows;
  for (std::size_t i = 0; i < Block::features(views); ++i) {
    Block::template rows<false>(block_, views, i, Linearization::measured, rows);
    (void)add_cost(views, i, rows.residual, rows.weight, loss, sums);
  }
}

template <ErrorBlock B, class S>
void BlockTerm<B, S>::add_normal_equations(const Views& views, const Loss& loss,
                                           TermSums<S>& sums) const {
  for (std::size_t first = 0, end = 0; first < Block::features(views); first = end) {
    end = end_of_run(views, first);
    const BodyChains chains = Block::chains(views, first);
    if (add_difference(views, first, end, loss, sums)) continue;
    const Twists of_run = twists(views, chains);
    sums.wrenches.start(of_run, views.num_own());
    Rows rows;
    for (std::size_t i = first; i < end; ++i) {
      Block::template rows<true>(block_, views, i, Linearization::measured, rows);
      sums.wrenches.add(rows, add_cost(views, i, rows.residual, rows.weight, loss, sums));
    }
    sums.wrenches.finish();
    sums_of(views, chains, sums).add(sums.wrenches);
  }
}

template <ErrorBlock B, class S>
void BlockTerm<B, S>::evaluate(const Views& views, bool derivatives, Linearization at,
                               BatchRows<S>& out) const {
  const std::size_t features = Block::features(views);
  out.num_runs = 0;
  out.weight.resize(features);
  out.residual.resize(features * kSize);
  const S* factors = views.numbers.factors;
  out.factor.assign(factors, factors != nullptr ? factors + features : nullptr);
  std::size_t values = 0;
  for (std::size_t first = 0, end = 0; first < features; first = end) {
    end = end_of_run(views, first);
    auto& run = out.next_run();
    run.features = end - first;
    if (!derivatives) {
      Rows rows;
      for (std::size_t i = first; i < end; ++i) {
        Block::template rows<false>(block_, views, i, at, rows);
        store(i, rows.residual, rows.weight, out);
      }
      continue;
    }
    const BodyChains chains = Block::chains(views, first);
    const Twists of_run = twists(views, chains);
    const auto sizes = sizes_of(views, chains);
    views.columns(chains, run.columns);
    const std::size_t width = run.columns.size();
    run.jacobian = values;
    values += run.features * kSize * width;
    if (out.jacobian.size() < values) out.jacobian.resize(values);
    S* jacobian = out.jacobian.data() + run.jacobian;
    if (is_difference_ && at == Linearization::measured) {
      write_differences(views, first, end, of_run, sizes, out, jacobian);
    } else {
      for (std::size_t i = first; i < end; ++i, jacobian += kSize * width) {
        write_feature(views, i, at, of_run, out, jacobian, width);
      }
    }
  }
}

template <ErrorBlock B, class S>
KINECAL_FLATTEN void BlockTerm<B, S>::write_differences(const Views& views, std::size_t first,
                                                        std::size_t end, const Twists& twists,
                                                        const std::array<BodySizes, kBodies>& sizes,
                                                        BatchRows<S>& out, S* jacobian) const {
  if constexpr (kMayBeDifference) {
    kinecal::write_differences(views, first, end, twists, Sizes{sizes[0], sizes[1]}, jacobian,
                               residuals_to(views, out));
  }
}

}  // namespace kinecal
