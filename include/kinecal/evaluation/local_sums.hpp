// Normal equations of features, second step: the twists of the parameters, without a Jacobian.
//
// The first step has summed the features of a pack to a small matrix K over [ twist of each body |
// own | residual ] (feature_gram.hpp, difference_gram.hpp).  Then
//
//   J^T J = E^T K E      J^T r = E^T K e_r
//
// with E the twists of each body, and the identity for own parameters.  All numbers are packets: one
// sample per lane.
// Source: ARCHITECTURE.md, idea 6: the compressed cost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "kinecal/evaluation/normal_equations.hpp"
#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal {

/// Normal equations of features on the same chains, summed over samples lane by lane.
template <class S>
class LocalSums {
 public:
  using Twists = std::span<const BodyTwists<S>>;  ///< of each body

  /// @param columns  of the whole Jacobian: TermViews::columns()
  explicit LocalSums(std::vector<int> columns)
      : columns_(std::move(columns)), stride_(columns_.size() + 1) {
    set_zero();
  }

  /// Starts a new sum.
  void set_zero() { sums_.assign(stride_ * columns_.size(), S(0.0)); }

  /// Adds E^T K E of one pack.
  /// @param gram    K
  /// @param twists  of each body, as K takes them
  template <class Gram>
  void expand(const Gram& gram, Twists twists) {
    effects_.resize(kMostAtOnce * gram.width());
    std::size_t i = 0;
    for (std::size_t s = 0; s < twists.size(); ++s) {
      const std::size_t first = i;
      i = add_columns<6>(gram, twists, s, first, i, twists[s].rotational_numbers(),
                         twists[s].rotational.size());
      i = add_columns<3>(gram, twists, s, first, i, twists[s].translational_numbers(),
                         twists[s].translational.size());
    }
    for (std::size_t c = 0; gram.rest() + c + 1 < gram.width(); ++c, ++i) {
      S* sums = row(i) + i;
      const S* k = gram.own_row(c);
      for (std::size_t j = gram.rest() + c; j < gram.width(); ++j) *sums++ += *k++;
    }
  }

  /// Adds the sum of all lanes to normal equations over the columns of the whole Jacobian.
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
  static constexpr std::size_t kMostAtOnce = 3;

  /// Row i: sums of products with each local column j >= i, then with the residual.
  [[nodiscard]] S* row(std::size_t i) { return &sums_[i * stride_]; }
  [[nodiscard]] const S* row(std::size_t i) const { return &sums_[i * stride_]; }

  /// Adds the rows of some local columns of body s, up to three at a time, which reads each number
  /// once for three columns.  With eight lanes, one at a time was measured to be as fast.
  /// @param first  local column at which body s starts
  /// @param i      the first of the local columns
  /// @returns      the local column after the last one
  template <int D, class Gram>
  std::size_t add_columns(const Gram& gram, Twists twists, std::size_t s, std::size_t first,
                          std::size_t i, const S* xi, std::size_t count) {
    const auto add = [&]<int R>(std::integral_constant<int, R>) {
      gram.template effects<D, R>(s, xi, effects_.data());
      add_products<D, R>(gram, twists, s, i - first, row(i) + i);
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

  /// Adds xi_j^T effects for the columns j of body s after the first `skip`, and for all further
  /// columns.
  /// @tparam D     numbers per twist of the columns that have these effects
  /// @param  sums  of the first of these columns with the first column j
  template <int D, int R, class Gram>
  void add_products(const Gram& gram, Twists twists, std::size_t s, std::size_t skip, S* sums) {
    constexpr int kFelt = D == 3 && Gram::kShiftsFeltAsForces ? 3 : 6;
    // Packets may alias anything: the compiler rereads whatever is not a local variable.
    const std::size_t stride = stride_;
    const S* effects = effects_.data();
    for (std::size_t b = s; b < twists.size(); ++b, skip = 0) {
      const std::size_t turns = twists[b].rotational.size(), shifts = twists[b].translational.size();
      const std::size_t no_turns = std::min(skip, turns), no_shifts = skip - no_turns;
      const S *force = effects + R * gram.force(b), *moment = effects + R * gram.moment(b);
      sums = add_dots<6, kFelt, R>(force, moment, twists[b].rotational_numbers() + 6 * no_turns,
                                   turns - no_turns, sums, stride);
      sums = add_dots<3, 3, R>(force, moment, twists[b].translational_numbers() + 3 * no_shifts,
                               shifts - no_shifts, sums, stride);
    }
    const S* end = effects + R * gram.width();
    for (effects += R * gram.rest(); effects != end; effects += R, ++sums) {
      for (std::size_t r = 0; r < R; ++r) sums[r * stride] += effects[r];
    }
  }

  /// @tparam D     numbers per xi
  /// @tparam Felt  how many of them have an effect
  /// @returns      the sums after the last one
  template <int D, std::size_t Felt, std::size_t R>
  static S* add_dots(const S* force, const S* moment, const S* xi, std::size_t count, S* sums,
                     std::size_t stride) {
    std::array<S, R * Felt> e;
    for (std::size_t n = 0; n < R * 3; ++n) e[n] = force[n];
    for (std::size_t n = R * 3; n < R * Felt; ++n) e[n] = moment[n - R * 3];
    for (const S* end = sums + count; sums != end; xi += D, ++sums) {
      std::array<S, R> sum;
      for (std::size_t r = 0; r < R; ++r) sum[r] = sums[r * stride];
      for (std::size_t d = 0; d < Felt; ++d) {
        const S factor = xi[d];
        for (std::size_t r = 0; r < R; ++r) sum[r] += factor * e[d * R + r];
      }
      for (std::size_t r = 0; r < R; ++r) sums[r * stride] = sum[r];
    }
    return sums;
  }

  std::vector<int> columns_;
  std::size_t stride_;
  std::vector<S> sums_;
  std::vector<S> effects_;
};

}  // namespace kinecal
