// Terms made of error blocks.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/crate/block_rows.hpp"
#include "kinecal/crate/difference_moments.hpp"
#include "kinecal/crate/jacobian_rows.hpp"

namespace kinecal {

template <ErrorBlock B, class S>
class BlockTerm final : public Term<S> {
 public:
  static constexpr int kSize = kResiduals<B>;
  using typename Term<S>::Views;
  using typename Term<S>::Observations;

  BlockTerm(std::string name, B block, std::vector<int> sensors, TermOptions options)
      : Term<S>(std::move(name), std::move(sensors), std::move(options)),
        block_(std::move(block)) {}

  [[nodiscard]] int feature_size() const override { return kSize; }

  [[nodiscard]] bool pairs_features() const override { return PointPairBlock<B> || SightBlock<B>; }

  [[nodiscard]] int count(Observations seen) const override {
    if constexpr (PlanePairBlock<B>) return 1;
    int n = 0;
    for (std::size_t i = 0; i < seen[0]->usable.size(); ++i) {
      n += std::all_of(seen.begin(), seen.end(), [i](auto* o) { return o->usable[i] > 0.0; });
    }
    return n;
  }

  [[nodiscard]] std::string why_not(Observations seen) const override {
    if constexpr (PlanePairBlock<B>) {
      for (const auto* observation : seen) {
        if (std::string why = why_no_plane(*observation); !why.empty()) return why;
      }
    }
    return {};
  }

  void add_cost(Views views, const Loss& loss, TermSums<S>& sums) const override {
    for (std::size_t i = 0; i < Block::features(views); ++i) {
      const Rows rows = Block::template rows<false>(block_, views, i, Linearization::measured);
      (void)add_cost(rows.residual, rows.weight, loss, sums);
    }
  }

  void add_normal_equations(Views views, const Loss& loss, TermSums<S>& sums) const override {
    for (std::size_t first = 0, end = 0; first < Block::features(views); first = end) {
      end = end_of_run(views, first);
      const Chains chains = Block::chains(views, first);
      if constexpr (kIsDifference<B>) {
        sums.weights.resize(end - first);
        sums.residuals.resize(end - first);
        for (std::size_t i = first; i < end; ++i) {
          Vector3<S>& r = sums.residuals[i - first];
          r = block_(views[0]->points()[i], views[1]->points()[i]);
          sums.weights[i - first] = add_cost(r, Block::weight(views, i), loss, sums);
        }
        DifferenceMoments<S>(views, first, sums.weights, sums.residuals).fill(sums.gram);
      } else {
        sums.gram.resize(kBodies, Block::cameras(views, first));
        sums.gram.set_zero();
        for (std::size_t i = first; i < end; ++i) {
          const Rows rows = Block::template rows<true>(block_, views, i, Linearization::measured);
          sums.gram.add(rows, add_cost(rows.residual, rows.weight, loss, sums));
        }
        sums.gram.complete();
      }
      sums_of(views, chains, sums).expand(sums.gram, twists(views, chains));
    }
  }

  void evaluate(Views views, bool derivatives, Linearization at,
                PackedRows<S>& out) const override {
    const std::size_t features = Block::features(views);
    out.num_runs = 0;
    out.weight.resize(features);
    out.residual.resize(features * kSize);
    std::size_t values = 0;
    for (std::size_t first = 0, end = 0; first < features; first = end) {
      end = end_of_run(views, first);
      auto& run = out.next_run();
      run.features = end - first;
      if (!derivatives) continue;
      local_columns(views, Block::chains(views, first), run.columns);
      run.jacobian = values;
      values += run.features * kSize * run.columns.size();
    }
    if (derivatives) out.jacobian.resize(values);
    std::size_t i = 0;
    for (std::size_t r = 0; r < out.num_runs; ++r) {
      const auto& run = out.runs[r];
      const Twists of_run = twists(views, Block::chains(views, i));
      const std::size_t width = run.columns.size();
      S* jacobian = derivatives ? &out.jacobian[run.jacobian] : nullptr;
      for (std::size_t n = 0; n < run.features; ++n, ++i) {
        evaluate_feature(views, i, at, of_run, out, jacobian, width);
        if (derivatives) jacobian += kSize * width;
      }
    }
  }

 private:
  using Block = BlockRows<B, S>;
  using Rows = typename Block::Rows;
  static constexpr std::size_t kBodies = Block::kBodies;
  using Chains = BodyChains<kBodies>;
  using Twists = std::array<const ChainTwists<S>*, kBodies>;

  /// The first feature after `first` that hangs on other chains.
  [[nodiscard]] static std::size_t end_of_run(Views views, std::size_t first) {
    std::size_t end = first + 1;
    const Chains chains = Block::chains(views, first);
    while (end < Block::features(views) && Block::chains(views, end) == chains) ++end;
    return end;
  }

  /// Adds what a feature costs.
  /// @returns  the weight of its normal equations
  S add_cost(const Eigen::Matrix<S, kSize, 1>& residual, const S& weight, const Loss& loss,
             TermSums<S>& sums) const {
    const S w2(this->options().weight * this->options().weight);
    S squared(0.0);
    for (int m = 0; m < kSize; ++m) squared += residual(m) * residual(m);
    squared *= w2;
    const auto value = loss(squared);
    sums.twice_cost += weight * value.rho + S(0.0) * squared;  // infinite: not a number
    return weight * w2 * value.derivative;
  }

  [[nodiscard]] static Twists twists(Views views, const Chains& chains) {
    Twists result{};
    for (std::size_t s = 0; s < kBodies; ++s) result[s] = &views[s]->twists(chains[s]);
    return result;
  }

  [[nodiscard]] static LocalSums<S>& sums_of(Views views, const Chains& chains, TermSums<S>& sums) {
    BodyChains<2> key{};
    std::copy(chains.begin(), chains.end(), key.begin());
    // In the order of the chains, whichever was met first: sums are added up in it.
    const auto place = std::find_if(sums.by_chains.begin(), sums.by_chains.end(),
                                    [&key](const auto& known) { return !(known.first < key); });
    if (place != sums.by_chains.end() && place->first == key) return place->second;
    std::vector<int> columns;
    local_columns(views, chains, columns);
    return sums.by_chains.emplace(place, key, LocalSums<S>(std::move(columns)))->second;
  }

  /// @param jacobian  (kSize x width) where the rows of feature i go, or nullptr
  KINECAL_FLATTEN void evaluate_feature(Views views, std::size_t i, Linearization at,
                                        const Twists& twists, PackedRows<S>& out, S* jacobian,
                                        std::size_t width) const {
    if constexpr (kIsDifference<B>) {
      if (jacobian != nullptr && at == Linearization::measured) {
        const Vector3<S>&a = views[0]->points()[i], &b = views[1]->points()[i];
        store(i, block_(a, b), Block::weight(views, i), out);
        write_difference(views, i, twists, jacobian, width);
        return;
      }
    }
    const Rows rows = jacobian != nullptr ? Block::template rows<true>(block_, views, i, at)
                                          : Block::template rows<false>(block_, views, i, at);
    store(i, rows.residual, rows.weight, out);
    if (jacobian != nullptr) write_rows(rows, twists, jacobian, width);
  }

  static void store(std::size_t i, const Eigen::Matrix<S, kSize, 1>& residual, const S& weight,
                    PackedRows<S>& out) {
    out.weight[i] = weight;
    for (int m = 0; m < kSize; ++m) out.residual[i * kSize + std::size_t(m)] = residual(m);
  }

  B block_;
};

}  // namespace kinecal
