// Normal-equation sums of any error block: one small matrix per sample.
//
// The columns of a body's parameters are by_body xi_k.  The twists xi_k of its chain are the same
// for all features, so each sample sums a small matrix over its features,
//
//   K = sum of  w L^T L      L = [ residual | by_own | by_body of each body ]
//
// whose size depends neither on the number of features nor on that of parameters.  Its block for
// bodies b and s maps a twist xi of s to its wrench on b: K_bs xi.
// Source: ARCHITECTURE.md, ideas 2 (twists) and 6 (the compressed cost).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "kinecal/evaluation/rows/feature_rows.hpp"
#include "kinecal/evaluation/sums/local_sums.hpp"

namespace kinecal::detail {

/// Normal-equation sums for features of any kind.
template <class S>
class FeatureWrenches {
 public:
  /// Number of bodies.
  [[nodiscard]] std::size_t bodies() const { return twists_.size(); }
  /// Number of rotational and of translational twists of a body.
  /// @{
  [[nodiscard]] std::size_t turns(std::size_t body) const {
    return twists_[body]->rotational.size();
  }
  [[nodiscard]] std::size_t shifts(std::size_t body) const {
    return twists_[body]->translational.size();
  }
  /// @}
  /// Number of the own parameters of sensors and block.
  [[nodiscard]] std::size_t own() const { return own_; }

  /// The twists of columns i, i + 1, ...
  [[nodiscard]] PacketRows<S> twists(std::size_t i) const {
    return {columns_.data() + i * size(), size(), 3};
  }
  /// Force and moment of each column on a body.
  [[nodiscard]] PacketRows<S> wrenches(std::size_t body) const {
    return {columns_.data() + 6 + 6 * body, size(), 3};
  }
  /// Adds the products of the columns of own parameters with each other and with the residual.
  void add_own(S* sums, std::size_t stride) const {
    for (std::size_t c = 1; c <= own_; ++c) {
      for (std::size_t i = 0; i <= c; ++i) sums[c * stride + i] += row(c)[i];
    }
  }

  /// Starts a sum over features.
  /// @param twists  of each body; must live until the sums are added
  /// @param own     number of the own parameters of sensors and block
  void start(std::span<const ChainTwists<S>* const> twists, std::size_t own);
  /// Adds w L^T L of a feature.
  template <int M, int Bodies>
  void add(const FeatureRows<S, M, Bodies>& rows, const S& weight) {
    using std::sqrt;
    constexpr std::size_t kRows = M;
    std::array<std::array<S, kRows>, 1 + kMostOwn + 6 * std::size_t(Bodies)>
        columns;  // of L, scaled
    const S root = sqrt(weight);
    for (std::size_t m = 0; m < kRows; ++m) {
      const auto row = static_cast<int>(m);
      std::size_t n = 0;
      columns[n++][m] = root * rows.residual(row);
      for (std::size_t c = 0; c < rows.own; ++c) columns[n++][m] = root * rows.by_own[c](row);
      for (std::size_t s = 0; s < Bodies; ++s) {
        for (int k = 0; k < 6; ++k) columns[n++][m] = root * rows.by_body[s](row, k);
      }
    }
    const PacketRows<S> l{columns[0].data(), kRows, 3};
    if (empty_) {
      multiply<false, kRows, 1>(l, width_, l, 1, k_.data(), width_);
    } else {
      add_products<kRows>(l, width_, l, 0, k_.data(), width_);
    }
    empty_ = false;
  }
  /// Computes the wrenches after all features have been added.
  void finish();

 private:
  /// Row i of K: the lower triangle within a body, full rows between bodies; after finish() all of it.
  [[nodiscard]] const S* row(std::size_t i) const { return &k_[i * width_]; }

  /// Numbers per column: its twist, and a wrench on each body.
  [[nodiscard]] std::size_t size() const { return 6 + 6 * bodies(); }

  /// Some twists of a body and their wrenches: the forces on all bodies and, with D = 6, the
  /// moments on this body and those after it.
  /// @returns  the column after the last one
  template <std::size_t D>
  S* set_columns(std::size_t body, const S* xi, std::size_t count, S* column) const;

  std::span<const ChainTwists<S>* const> twists_;
  std::size_t own_ = 0, width_ = 0;
  bool empty_ = true;
  std::vector<S> k_;
  std::vector<S> columns_;  ///< in the order of LocalSums
};

}  // namespace kinecal::detail
