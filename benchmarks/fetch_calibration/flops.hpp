// Number of floating-point operations of the wide jets, counted by running them on counting
// numbers.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "counting.hpp"
#include "wide_jets.hpp"

namespace kinecal::bench {

// ceres::Jet<T> takes constants of type T only; the walk has constants of type double.
template <int N>
ceres::Jet<Counting, N> operator*(const ceres::Jet<Counting, N>& x, double s) {
  return x * Counting(s);
}
template <int N>
ceres::Jet<Counting, N> operator*(double s, const ceres::Jet<Counting, N>& x) {
  return x * Counting(s);
}
template <int N>
ceres::Jet<Counting, N> operator+(double s, const ceres::Jet<Counting, N>& x) {
  return Counting(s) + x;
}
template <int N>
ceres::Jet<Counting, N> operator-(double s, const ceres::Jet<Counting, N>& x) {
  return Counting(s) - x;
}

/// Operations of a product J^T J and J^T r over the rows of one sample, symmetry unused.
inline constexpr double kFullSums = 2.0 * kRows * kParameters * (kParameters + 1);

namespace detail {

/// Operations per sample in the scalar S, including its share of what is done once for all samples.
template <class S>
[[nodiscard]] double walk_operations(const FetchWork& work, const std::array<S, kParameters>& x) {
  const WalkModel model(work);
  const WalkSample sample = model.pack(work.sightings(1).front());
  WalkState<S> state;
  std::array<S, kRows> residuals;
  const Operations once = operations_of([&] { state = model.state(std::span<const S>(x)); });
  const Operations each = operations_of([&] { model.residuals(state, sample, residuals.data()); });
  return double(each.total()) + double(once.total()) / kSamples;
}

}  // namespace detail

[[nodiscard]] inline Flops wide_jet_flops(const FetchWork& work) {
  const Eigen::VectorXd values = work.timed_values();
  std::array<Counting, kParameters> numbers;
  std::array<ceres::Jet<Counting, kParameters>, kParameters> jets;
  for (int i = 0; i < kParameters; ++i) {
    const auto index = static_cast<std::size_t>(i);
    numbers[index] = values(i);
    jets[index] = ceres::Jet<Counting, kParameters>(Counting(values(i)), i);
  }
  Flops flops{detail::walk_operations(work, numbers), detail::walk_operations(work, jets)};
  flops.normal_equations = flops.residual_jacobian + kFullSums;
  return flops;
}

}  // namespace kinecal::bench
