// Definitions of local_sums.hpp, for a scalar S.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/evaluation/sums/local_sums.hpp"

namespace kinecal::detail {

template <class S>
LocalSums<S>::LocalSums(std::vector<int> columns)
    : columns_(std::move(columns)), stride_(columns_.size() + 1), sums_(stride_ * stride_) {
  set_zero();
}

template <class S>
void LocalSums<S>::set_zero() {
  for (std::size_t i = 0; i < stride_; ++i) std::fill_n(&sums_[i * stride_], i + 1, S(0.0));
}

template <class S>
void LocalSums<S>::add_to(NormalEquations& total) const {
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

}  // namespace kinecal::detail
