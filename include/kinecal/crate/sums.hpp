// Normal equations from features, without forming their Jacobian.
//
// The columns of a body's parameters are by_body xi_k with the twists xi_k of its chain, the same
// for all features.  So per sample a small matrix is summed over the features,
//
//   K = sum of  w L^T L      L = [ by_body of each body | by_camera | residual ]
//
// whose size depends neither on the number of features nor on that of parameters, and the twists
// enter once:  J^T J = E^T K E,  J^T r = E^T K e_r,  with E the twists of each body, and the
// identity for cameras.  K and the sums are of a pack: one sample in each lane. Source: the design
// of kinecal, ideas 2 and 6.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "kinecal/crate/feature_rows.hpp"
#include "kinecal/crate/normal_equations.hpp"

namespace kinecal {

/// The matrix K of one sample; its upper triangle, and both triangles of each body's own 6 x 6.
template <class S>
class FeatureGram {
 public:
  /// Its contents are not defined.
  /// @param bodies, cameras  number of bodies and of free camera parameters
  void resize(std::size_t bodies, std::size_t cameras) {
    bodies_ = bodies;
    width_ = 6 * bodies + cameras + 1;
    k_.resize(width_ * width_);
  }
  [[nodiscard]] std::size_t width() const { return width_; }
  [[nodiscard]] S* row(std::size_t i) { return &k_[i * width_]; }
  [[nodiscard]] const S* row(std::size_t i) const { return &k_[i * width_]; }

  void set_zero() {
    for (std::size_t i = 0; i < width_; ++i) std::fill(row(i) + i, row(i) + width_, S(0.0));
  }

  /// Adds w L^T L of one feature.
  template <int M, int Bodies>
  void add(const FeatureRows<S, M, Bodies>& rows, const S& weight) {
    constexpr std::size_t kRows = M;
    using Columns =
        std::array<std::array<S, kRows>, 6 * Bodies + FeatureRows<S, M, Bodies>::kMaxCameras + 1>;
    Columns l;  // column by column
    for (std::size_t m = 0; m < kRows; ++m) {
      const auto row = static_cast<int>(m);
      std::size_t n = 0;
      for (std::size_t s = 0; s < Bodies; ++s) {
        for (int k = 0; k < 6; ++k) l[n++][m] = rows.by_body[s](row, k);
      }
      for (std::size_t c = 0; c < rows.cameras; ++c) l[n++][m] = rows.by_camera[c](row);
      l[n][m] = rows.residual(row);
    }
    for (std::size_t i = 0; i + 1 < width_; ++i) {
      std::array<S, kRows> weighted;
      for (std::size_t m = 0; m < kRows; ++m) weighted[m] = weight * l[i][m];
      S* k = row(i);
      for (std::size_t j = i; j < width_; ++j) {
        S sum = k[j];
        for (std::size_t m = 0; m < kRows; ++m) sum += weighted[m] * l[j][m];
        k[j] = sum;
      }
    }
  }

  /// Completes each body's own block, which is read as a whole.
  void complete() {
    for (std::size_t s = 0; s < bodies_; ++s) {
      for (std::size_t i = 6 * s; i < 6 * s + 6; ++i) {
        for (std::size_t j = 6 * s; j < i; ++j) row(i)[j] = row(j)[i];
      }
    }
  }

 private:
  std::size_t bodies_ = 0, width_ = 0;
  std::vector<S> k_;
};

/// Normal equations of features that hang on the same chains, summed over samples lane by lane.
template <class S>
class LocalSums {
 public:
  using Twists = std::span<const ChainTwists<S>* const>;

  explicit LocalSums(std::vector<int> columns)
      : columns_(std::move(columns)), stride_(columns_.size() + 1) {
    set_zero();
  }

  void set_zero() { sums_.assign(stride_ * columns_.size(), S(0.0)); }

  /// Adds the twists' share: E^T K E.
  /// @param twists  of the chain of each body
  void expand(const FeatureGram<S>& gram, Twists twists) {
    effects_.resize(3 * gram.width());
    std::size_t i = 0;
    for (std::size_t s = 0; s < twists.size(); ++s) {
      const std::size_t first = i;
      i = add_columns<6>(gram, twists, s, first, i, turns(twists[s]), twists[s]->turns.size());
      i = add_columns<3>(gram, twists, s, first, i, shifts(twists[s]), twists[s]->shifts.size());
    }
    for (std::size_t c = 6 * twists.size(); c + 1 < gram.width(); ++c, ++i) {
      S* sums = row(i) + i;
      const S* k = gram.row(c);
      for (std::size_t j = c; j < gram.width(); ++j) *sums++ += k[j];
    }
  }

  /// Adds all lanes to the sums over the whole Jacobian's columns.
  void add_to(NormalEquations& total) const {
    const std::size_t n = columns_.size();
    for (std::size_t i = 0; i < n; ++i) {
      const S* sums = row(i);
      const int a = columns_[i];
      for (std::size_t j = i; j < n; ++j) {
        const int b = columns_[j];
        const double h = sum_of_lanes(sums[j]);
        total.hessian(a, b) += h;
        if (i != j) total.hessian(b, a) += h;
      }
      total.gradient(a) += sum_of_lanes(sums[n]);
    }
  }

 private:
  /// Row i: for each local column j >= i the sum of their products, then that with the residual.
  [[nodiscard]] S* row(std::size_t i) { return &sums_[i * stride_]; }
  [[nodiscard]] const S* row(std::size_t i) const { return &sums_[i * stride_]; }

  /// Twists as numbers, 6 or 3 a column.
  [[nodiscard]] static const S* turns(const ChainTwists<S>* twists) {
    static_assert(sizeof(Twist<S>) == 6 * sizeof(S) && sizeof(Vector3<S>) == 3 * sizeof(S));
    return twists->turns.empty() ? nullptr : twists->turns[0].linear.data();
  }
  [[nodiscard]] static const S* shifts(const ChainTwists<S>* twists) {
    return twists->shifts.empty() ? nullptr : twists->shifts[0].data();
  }

  /// Adds the rows of some local columns of body s, up to three at a time: each number that is read
  /// then serves as often.  Eight lanes wide, one at a time was measured to be as quick.
  /// @param first  local column at which body s starts
  /// @param i      local column of the first of them
  /// @returns      the local column after them
  template <int D>
  std::size_t add_columns(const FeatureGram<S>& gram, Twists twists, std::size_t s,
                          std::size_t first, std::size_t i, const S* xi, std::size_t count) {
    const auto add = [&]<int R>(std::integral_constant<int, R>) {
      apply<D, R>(gram, s, xi);
      add_products<R>(twists, s, first, i);
      i += R;
      xi += R * D;
      count -= R;
    };
    if constexpr (kLanes<S> < 8) {
      while (count == 3 || count > 4) add(std::integral_constant<int, 3>{});
      while (count >= 2) add(std::integral_constant<int, 2>{});
    }
    while (count > 0) add(std::integral_constant<int, 1>{});
    return i;
  }

  /// effects = K xi, for what stands to the right of body s, body s included, of R columns xi.
  template <int D, int R>
  void apply(const FeatureGram<S>& gram, std::size_t s, const S* xi) {
    const std::size_t w = gram.width();
    const S* k = gram.row(6 * s);
    std::array<S, R * D> x;
    for (std::size_t n = 0; n < R * D; ++n) x[n] = xi[n];
    S* effects = effects_.data();
    for (std::size_t j = 6 * s; j < w; ++j) {
      std::array<S, R> sum;
      for (std::size_t r = 0; r < R; ++r) sum[r] = k[j] * x[r * D];
      for (std::size_t d = 1; d < D; ++d) {
        const S factor = k[j + d * w];
        for (std::size_t r = 0; r < R; ++r) sum[r] += factor * x[r * D + d];
      }
      for (std::size_t r = 0; r < R; ++r) effects[r * w + j] = sum[r];
    }
  }

  /// Adds xi_j^T effects for the local columns j from i on to the rows i ... i + R - 1.
  template <int R>
  void add_products(Twists twists, std::size_t s, std::size_t first, std::size_t i) {
    const std::size_t w = effects_.size() / 3;
    S* sums = row(i) + i;
    std::size_t skip = i - first;
    for (std::size_t b = s; b < twists.size(); ++b) {
      const std::size_t turns_here = twists[b]->turns.size(),
                        shifts_here = twists[b]->shifts.size();
      const std::size_t no_turns = std::min(skip, turns_here), no_shifts = skip - no_turns;
      add_products<6, R>(b, turns(twists[b]) + 6 * no_turns, turns_here - no_turns, sums);
      add_products<3, R>(b, shifts(twists[b]) + 3 * no_shifts, shifts_here - no_shifts, sums);
      skip = 0;
    }
    for (std::size_t k = 6 * twists.size(); k < w; ++k, ++sums) {
      for (std::size_t r = 0; r < R; ++r) sums[r * stride_] += effects_[r * w + k];
    }
  }

  template <int D, int R>
  void add_products(std::size_t body, const S* xi, std::size_t count, S*& sums) {
    const std::size_t w = effects_.size() / 3;
    std::array<S, R * D> e;
    for (std::size_t r = 0; r < R; ++r) {
      for (std::size_t d = 0; d < D; ++d) e[r * D + d] = effects_[r * w + 6 * body + d];
    }
    for (; count > 0; --count, xi += D, ++sums) {
      std::array<S, R> sum;
      for (std::size_t r = 0; r < R; ++r) sum[r] = sums[r * stride_];
      for (std::size_t d = 0; d < D; ++d) {
        const S factor = xi[d];
        for (std::size_t r = 0; r < R; ++r) sum[r] += factor * e[r * D + d];
      }
      for (std::size_t r = 0; r < R; ++r) sums[r * stride_] = sum[r];
    }
  }

  std::vector<int> columns_;
  std::size_t stride_;
  std::vector<S> sums_;
  std::vector<S> effects_;
};

}  // namespace kinecal
