// Normal equations of features, second step: multiplies by twists, without forming a Jacobian.
//
// The first step (FeatureWrenches, PointWrenches) has summed the features of a batch.  A parameter
// moves a body by its twist; the features respond with a wrench on each body, a force and a moment.
// Then
//
//   (J^T J)(i, j) = twist_i . wrench_j on the body of i
//
// All numbers are packets: one sample per lane.  Products of rows and columns are summed tile by
// tile in registers: each loaded number of a tile serves several products.
// Source: ARCHITECTURE.md, idea 6: the compressed cost.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <vector>

#include "kinecal/evaluation/sums/products.hpp"

namespace kinecal {
struct NormalEquations;
}

namespace kinecal::detail {

/// Twists of the columns, and the force and moment of each on every body.  Models: FeatureWrenches,
/// PointWrenches.
template <class W, class S>
concept Wrenches = requires(const W& w, std::size_t i, S* sums) {
  { w.bodies() } -> std::same_as<std::size_t>;       // number of bodies
  { w.turns(i) } -> std::same_as<std::size_t>;       // rotational twists of a body
  { w.shifts(i) } -> std::same_as<std::size_t>;      // translational twists of a body
  { w.own() } -> std::same_as<std::size_t>;          // own parameters of sensors and block
  { w.twists(i) } -> std::same_as<PacketRows<S>>;    // of the columns from i on
  { w.wrenches(i) } -> std::same_as<PacketRows<S>>;  // of all columns on a body
  w.add_own(sums, i);                                // products of own columns and the residual
};

/// Normal equations of features on the same chains, summed over samples lane by lane.
///
/// The columns are those of a FeatureRun, after the residual's column.  Translational twists come
/// last, so their products with all other columns need three numbers instead of six.
template <class S>
class LocalSums {
 public:
  /// @param columns  of the whole Jacobian: FeatureRun::columns
  explicit LocalSums(std::vector<int> columns);

  /// Starts a new sum.
  void set_zero();

  /// Adds one batch.
  /// @param wrenches  twists and their wrenches
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

  /// Adds the sum of all lanes to the normal equations of the whole Jacobian.
  void add_to(NormalEquations& total) const;

 private:
  std::vector<int> columns_;
  std::size_t stride_;
  std::vector<S> sums_;
};

}  // namespace kinecal::detail
