// Definitions of feature_wrenches.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/sums/feature_wrenches.hpp"

namespace kinecal::detail {

template <class S>
void FeatureWrenches<S>::start(std::span<const ChainTwists<S>* const> twists, std::size_t own) {
  twists_ = twists;
  own_ = own;
  width_ = 1 + own + 6 * twists.size();
  k_.resize(width_ * width_);
  empty_ = true;
}

template <class S>
void FeatureWrenches<S>::finish() {
  const std::size_t others = 1 + own_;
  for (std::size_t i = others; i < width_; ++i) {
    for (std::size_t j = others; j < i; ++j) k_[j * width_ + i] = row(i)[j];
  }
  std::size_t columns = others;
  for (std::size_t s = 0; s < bodies(); ++s) columns += turns(s) + shifts(s);
  columns_.resize(columns * size());
  S* column = columns_.data();
  for (std::size_t c = 0; c < others; ++c, column += size()) {
    for (std::size_t i = 0; i < 6 * bodies(); ++i) column[6 + i] = row(others + i)[c];
  }
  for (std::size_t s = 0; s < bodies(); ++s) {
    if (turns(s) == 0) continue;
    column = set_columns<6>(s, twists_[s]->rotational[0].linear.data(), turns(s), column);
  }
  for (std::size_t s = 0; s < bodies(); ++s) {
    if (shifts(s) == 0) continue;
    column = set_columns<3>(s, twists_[s]->translational[0].data(), shifts(s), column);
  }
}

template <class S>
template <std::size_t D>
S* FeatureWrenches<S>::set_columns(std::size_t body, const S* xi, std::size_t count,
                                   S* column) const {
  static_assert(sizeof(Twist<S>) == 6 * sizeof(S) && sizeof(Vector3<S>) == 3 * sizeof(S));
  const std::size_t first = 1 + own_;
  for (std::size_t b = 0; b < bodies(); ++b) {
    const PacketRows<S> k{row(first + 6 * b) + first + 6 * body, width_, 3};
    multiply<false, D, 0, S>({xi, D, 3}, count, k, D == 6 && b >= body ? 6 : 3, column + 6 + 6 * b,
                             size());
  }
  for (const S* end = xi + D * count; xi != end; column += size()) {
    for (std::size_t d = 0; d < D; ++d) column[d] = *xi++;
  }
  return column;
}

}  // namespace kinecal::detail
