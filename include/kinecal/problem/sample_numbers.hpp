// A sample as numbers, and what samples must have in common to be evaluated together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <compare>
#include <optional>
#include <vector>

namespace kinecal::detail {

/// What one sensor observed in one sample.
struct ObservationNumbers {
  std::vector<std::size_t> chain;  ///< of each feature: the sensor's chain to it
  std::vector<double> usable;      ///< of each feature: one, or zero if it is NaN
  std::vector<double> variance;  ///< of each feature: its sigma squared, or zero; empty: no sigmas
  std::vector<double> measured;  ///< of each feature: 3, or 12 with an orientation
  std::vector<double> settings;  ///< see AnySensor::settings()
  /// Of each chain to a feature: the numbers of JointStates.
  std::vector<std::optional<std::vector<double>>> joints;

  /// True if some feature is NaN.
  [[nodiscard]] bool misses_some() const {
    return std::find(usable.begin(), usable.end(), 0.0) != usable.end();
  }
};

/// What a term takes of one sample besides the observations of its sensors.
struct TermNumbers {
  /// Of each feature: the block's sigma over the feature's own; empty if no feature has its own.
  std::vector<double> factors;
  std::vector<double> conditions;  ///< those that the block takes, in its order
};

/// One sample of a problem.
struct SampleNumbers {
  std::vector<std::optional<ObservationNumbers>> sensors;  ///< what each sensor observed
  std::vector<TermNumbers> terms;                          ///< of the terms that apply
};

/// What samples must have in common to share batches.
struct SampleLayout {
  std::vector<std::optional<std::vector<std::size_t>>> chains;  ///< of each feature, by sensor
  std::vector<bool> misses_some;                                ///< by sensor: a feature is NaN
  std::vector<int> terms;                                       ///< indices of the terms that apply
  std::vector<int> weighted;  ///< those of them in which a feature has a sigma of its own

  /// Any strict order, for a map.
  auto operator<=>(const SampleLayout&) const = default;  // NOLINT(modernize-use-nullptr)
};

}  // namespace kinecal::detail
