// A sample as a row of numbers, and what each of them is.
//
// Samples of one layout (the same sensors observed the same number of features in the same frames, and the same
// terms apply) share batches: see batches.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/mounted_sensor.hpp"

namespace kinecal::detail {

/// Marks an absent offset.
inline constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);

/// Offsets of an observation's numbers in a row.
struct ObservationLayout {
  std::vector<std::size_t> chain;   ///< of each feature: the sensor's chain to it
  std::vector<std::size_t> joints;  ///< of each chain: offset of its JointStates, or kAbsent
  std::size_t measured = 0, settings = 0, usable = 0;  ///< offset of each
  std::size_t usable_step = 0;  ///< one, or zero if no feature is missing: one flag for all
  std::size_t width = 3;        ///< numbers of each feature in `measured`

  auto operator<=>(const ObservationLayout&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Offsets of a term's inputs in a row, besides the observations of its sensors.
struct TermLayout {
  int term = 0;  ///< its index in the problem
  std::size_t inverse_sigmas =
      kAbsent;                 ///< first number, or kAbsent if no feature has its own sigma
  std::size_t conditions = 0;  ///< first number
  std::size_t conditions_step =
      0;  ///< from a feature's to the next one's; zero: they are the sample's

  auto operator<=>(const TermLayout&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// Meaning of the numbers in a row.  Samples with the same layout share batches.
struct SampleLayout {
  std::vector<std::optional<ObservationLayout>> sensors;  ///< nullopt: observed nothing
  std::vector<TermLayout> terms;                          ///< of the terms that apply
  std::size_t size = 0;                                   ///< number of numbers

  /// An arbitrary strict order, for use in a map.
  auto operator<=>(const SampleLayout&) const = default;  // NOLINT(modernize-use-nullptr)
};

/// A sample as a row of numbers.
struct SampleRow {
  SampleLayout layout;          ///< their meaning
  std::vector<double> numbers;  ///< (layout.size)

  /// Appends the next sensor's observation; nullptr: none.
  void add_sensor(const ObservationNumbers* seen);
  /// Appends what a term takes.
  /// @param inverse_sigmas  of each feature: 1 / sigma, or 0 if it has none; empty: none has one
  /// @param conditions  those that the block takes, in its order: of each feature, or of the sample
  /// @param step        number of those of a feature; zero: they are the sample's
  void add_term(int term, const std::vector<double>& inverse_sigmas,
                const std::vector<double>& conditions, std::size_t step);

 private:
  [[nodiscard]] std::size_t append(const std::vector<double>& more);
};

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/problem/sample_layout.ipp"
#endif
