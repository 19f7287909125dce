// Normal equations of features, second step: the twists of the parameters, without a Jacobian.
//
// The first step has summed the features of a batch to what resists a motion: FeatureWrenches,
// PointWrenches.  A parameter moves a body by its twist, and the features resist by a force and a
// moment on each body, the wrench.  Then
//
//   (J^T J)(i, j) = twist_i . wrench_j on the body of i
//
// All numbers are packets: one sample per lane.
// Source: ARCHITECTURE.md, idea 6: the compressed cost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <utility>
#include <vector>

#include "kinecal/evaluation/dot_products.hpp"
#include "kinecal/evaluation/normal_equations.hpp"
#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal::detail {

/// What resists motions: the twists of the columns, and a force and a moment of each on every body.
/// FeatureWrenches and PointWrenches are models.
template <class W, class S>
concept Wrenches = requires(const W& w, std::size_t i, S* sums) {
  { w.bodies() } -> std::same_as<std::size_t>;       // number of them
  { w.turns(i) } -> std::same_as<std::size_t>;       // rotational twists of a body
  { w.shifts(i) } -> std::same_as<std::size_t>;      // translational twists of a body
  { w.own() } -> std::same_as<std::size_t>;          // own parameters of sensors and block
  { w.twists(i) } -> std::same_as<PacketRows<S>>;    // of the columns from i on
  { w.wrenches(i) } -> std::same_as<PacketRows<S>>;  // of all columns on a body
  w.add_own(sums, i);                                // products of own columns and the residual
};

/// Normal equations of features on the same chains, summed over samples lane by lane.
///
/// The columns are those of a FeatureRun, after that of the residual.  Translational twists are the
/// last, so that they meet all others as rows, with three numbers in place of six.
template <class S>
class LocalSums {
 public:
  /// @param columns  of the whole Jacobian: FeatureRun::columns
  explicit LocalSums(std::vector<int> columns)
      : columns_(std::move(columns)), stride_(columns_.size() + 1), sums_(stride_ * stride_) {
    set_zero();
  }

  /// Starts a new sum.
  void set_zero() {
    for (std::size_t i = 0; i < stride_; ++i) std::fill_n(&sums_[i * stride_], i + 1, S(0.0));
  }

  /// Adds one batch.
  /// @param wrenches  twists, and what resists them
  void add(const Wrenches<S> auto& wrenches) {
    S* sums = sums_.data();
    wrenches.add_own(sums, stride_);
    std::size_t first = 1 + wrenches.own();
    for (std::size_t b = 0; b < wrenches.bodies(); first += wrenches.turns(b++)) {
      add_products<6, S>(wrenches.twists(first), wrenches.turns(b), wrenches.wrenches(b), first,
                         sums, stride_);
    }
    for (std::size_t b = 0; b < wrenches.bodies(); first += wrenches.shifts(b++)) {
      add_products<3, S>(wrenches.twists(first), wrenches.shifts(b), wrenches.wrenches(b), first,
                         sums, stride_);
    }
  }

  /// Adds the sum of all lanes to normal equations over the columns of the whole Jacobian.
  void add_to(NormalEquations& total) const {
    const S* sums = sums_.data();
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      sums += stride_;
      const int a = columns_[i];
      total.gradient(a) += sum_of_lanes(sums[0]);
      for (std::size_t j = 0; j <= i; ++j) {
        const int b = columns_[j];
        const double h = sum_of_lanes(sums[j + 1]);
        total.hessian(a, b) += h;
        if (i != j) total.hessian(b, a) += h;
      }
    }
  }

 private:
  std::vector<int> columns_;
  std::size_t stride_;
  std::vector<S> sums_;
};

}  // namespace kinecal::detail
