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

#include <array>
#include <concepts>
#include <utility>
#include <vector>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/kinematics/twist_walker.hpp"

namespace kinecal {
struct NormalEquations;
}

namespace kinecal::detail {

/// Addresses vectors whose numbers are stored in groups of three.
template <class S>
struct PacketRows {
  const S* data;     ///< the first three numbers of the first vector
  std::size_t size;  ///< stride from one vector to the next
  std::size_t next;  ///< stride from three numbers to the next three

  /// Number d of vector i.
  [[nodiscard]] const S& operator()(std::size_t i, std::size_t d) const {
    return data[i * size + d / 3 * next + d % 3];
  }
};

template <std::size_t N>
using Constant = std::integral_constant<std::size_t, N>;

/// Calls f(0) ... f(N - 1) with constants: arrays indexed by them stay in registers.
template <std::size_t N, class F>
void unrolled(const F& f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f(Constant<I>{}), ...);
  }
  (std::make_index_sequence<N>{});
}

/// The products of R rows with some columns.
template <bool kAdd, std::size_t D, std::size_t R, class S>
void multiply_rows(const PacketRows<S>& rows, PacketRows<S> columns, std::size_t count, S* sums,
                   std::size_t stride) {
  std::array<S, R * D> held;  // in registers if there are 32
  unrolled<R * D>([&](auto i) { held[i] = rows(i / D, i % D); });
  for (; count > 0; --count, columns.data += columns.size, ++sums) {
    std::array<S, R> sum;
    if constexpr (kAdd) unrolled<R>([&](auto r) { sum[r] = sums[r * stride]; });
    unrolled<D>([&](auto d) {
      const S number = in_register(columns(0, d));
      unrolled<R>([&](auto r) {
        const S product = held[r * D + d] * number;
        if constexpr (kAdd || d > 0) {
          sum[r] += product;
        } else {
          sum[r] = product;
        }
      });
    });
    unrolled<R>([&](auto r) { sums[r * stride] = sum[r]; });
  }
}

/// The products of some rows with columns; each row has kMore columns more than the one before.
/// @tparam kAdd        add them to the sums; else set the sums
/// @tparam D           numbers per row
/// @param count        number of rows
/// @param num_columns  of the first row
/// @param sums         (rows x stride), row-major
template <bool kAdd, std::size_t D, std::size_t kMore, class S>
KINECAL_FLATTEN void multiply(PacketRows<S> rows, std::size_t count, const PacketRows<S>& columns,
                              std::size_t num_columns, S* sums, std::size_t stride) {
  const auto next = [&]<std::size_t R>(Constant<R>) {
    multiply_rows<kAdd, D, R>(rows, columns, num_columns + (R - 1) * kMore, sums, stride);
    num_columns += R * kMore;
    rows.data += R * rows.size;
    sums += R * stride;
    count -= R;
  };
  if constexpr (kLanes<S> >= 8 && D <= 6) {  // uses 24 of 32 registers
    while (count == 4 || count > 6) next(Constant<4>{});
  }
  if constexpr (D <= 6) {
    while (count == 3 || count > 4) next(Constant<3>{});
  }
  while (count >= 2) next(Constant<2>{});
  if (count == 1) next(Constant<1>{});
}

/// Adds the products of rows with all columns up to their own: the lower triangle of the sums;
/// entries above it are undefined.
/// @param first  index of the first row, and of its own column
/// @param sums   (columns x stride), row-major
template <std::size_t D, class S>
void add_products(const PacketRows<S>& rows, std::size_t count, const PacketRows<S>& columns,
                  std::size_t first, S* sums, std::size_t stride) {
  multiply<true, D, 1>(rows, count, columns, first + 1, sums + first * stride, stride);
}

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
