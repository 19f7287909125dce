// Products of rows with columns, summed tile by tile in registers: each number of a tile is loaded once for several
// products.  All numbers are packets: one sample per lane.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "kinecal/geometry/packet.hpp"
#include "kinecal/linkage.hpp"

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

}  // namespace kinecal::detail
