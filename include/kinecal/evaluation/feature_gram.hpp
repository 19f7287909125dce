// Normal equations of features, first step: one small matrix per sample, for any error block.
//
// The columns of a body's parameters are by_body xi_k, with the twists xi_k of its chain, which are
// the same for all features.  So each sample sums a small matrix over its features,
//
//   K = sum of  w L^T L      L = [ by_body of each body | by_own | residual ]
//
// whose size depends neither on the number of features nor on that of parameters.  The twists enter
// once, afterwards: see local_sums.hpp.
// Source: ARCHITECTURE.md, ideas 2 (twists) and 6 (the compressed cost).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/evaluation/feature_rows.hpp"

namespace kinecal {

/// The matrix K of a pack; its upper triangle, and both triangles of each body's own 6 x 6.
template <class S>
class FeatureGram {
 public:
  /// False: a translation may have a force and a moment.
  static constexpr bool kShiftsFeltAsForces = false;
  /// Where effects() puts the force on a body.
  [[nodiscard]] static constexpr std::size_t force(std::size_t body) { return 6 * body; }
  /// Where effects() puts the moment on a body.
  [[nodiscard]] static constexpr std::size_t moment(std::size_t body) { return 6 * body + 3; }
  /// Where effects() puts the products with own parameters' columns and with the residual.
  [[nodiscard]] std::size_t rest() const { return 6 * bodies_; }
  /// Number of rows and columns of K.
  [[nodiscard]] std::size_t width() const { return width_; }

  /// Sets the size; the contents are undefined afterwards.
  /// @param bodies, own  number of bodies and of free parameters of sensors and block
  void resize(std::size_t bodies, std::size_t own) {
    bodies_ = bodies;
    width_ = 6 * bodies + own + 1;
    k_.resize(width_ * width_);
  }
  [[nodiscard]] S* row(std::size_t i) { return &k_[i * width_]; }              ///< row i of K
  [[nodiscard]] const S* row(std::size_t i) const { return &k_[i * width_]; }  ///< row i of K
  /// Products of the column of own parameter c with those from it on, and with the residual.
  [[nodiscard]] const S* own_row(std::size_t c) const { return row(rest() + c) + rest() + c; }

  /// Sets K = w L^T L of the first feature.
  template <int M, int Bodies>
  void set(const FeatureRows<S, M, Bodies>& rows, const S& weight) {
    sum<true>(rows, weight);
  }
  /// Adds w L^T L of a further feature.
  template <int M, int Bodies>
  void add(const FeatureRows<S, M, Bodies>& rows, const S& weight) {
    sum<false>(rows, weight);
  }
  /// Mirrors the upper triangle of each body's own block, which is read as a whole.
  void complete() {
    for (std::size_t s = 0; s < bodies_; ++s) {
      for (std::size_t i = 6 * s; i < 6 * s + 6; ++i) {
        for (std::size_t j = 6 * s; j < i; ++j) row(i)[j] = row(j)[i];
      }
    }
  }

  /// K xi of R twists of a body: the rows of that body and all further rows.
  /// @param xi       (R x D) D = 6: linear and angular; D = 3: linear only
  /// @param effects  (width x R)
  template <int D, int R>
  void effects(std::size_t body, const S* xi, S* __restrict effects) const {
    const std::size_t width = width_;
    const S *k = row(6 * body) + 6 * body, *end = row(6 * body) + width;
    for (effects += R * (6 * body); k != end; ++k, effects += R) {
      std::array<S, R> sum;
      for (std::size_t r = 0; r < R; ++r) sum[r] = *k * xi[r * D];
      for (std::size_t d = 1; d < D; ++d) {
        const S factor = k[d * width];
        for (std::size_t r = 0; r < R; ++r) sum[r] += factor * xi[r * D + d];
      }
      for (std::size_t r = 0; r < R; ++r) effects[r] = sum[r];
    }
  }

 private:
  template <bool kFirst, int M, int Bodies>
  void sum(const FeatureRows<S, M, Bodies>& rows, const S& weight) {
    constexpr std::size_t kRows = M;
    std::array<std::array<S, kRows>, 6 * Bodies + kMostOwn + 1> l;  // column by column
    for (std::size_t m = 0; m < kRows; ++m) {
      const auto row = static_cast<int>(m);
      std::size_t n = 0;
      for (std::size_t s = 0; s < Bodies; ++s) {
        for (int k = 0; k < 6; ++k) l[n++][m] = rows.by_body[s](row, k);
      }
      for (std::size_t c = 0; c < rows.own; ++c) l[n++][m] = rows.by_own[c](row);
      l[n][m] = rows.residual(row);
    }
    for (std::size_t i = 0; i + 1 < width_; ++i) {
      std::array<S, kRows> weighted;
      for (std::size_t m = 0; m < kRows; ++m) weighted[m] = weight * l[i][m];
      S* k = row(i);
      for (std::size_t j = i; j < width_; ++j) {
        S sum = weighted[0] * l[j][0];
        if constexpr (!kFirst) sum += k[j];
        for (std::size_t m = 1; m < kRows; ++m) sum += weighted[m] * l[j][m];
        k[j] = sum;
      }
    }
  }

  std::size_t bodies_ = 0, width_ = 0;
  std::vector<S> k_;
};

}  // namespace kinecal
