// Counts occurrences and keeps the first: a finding is reported once, not once per sample.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <span>
#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/text/counted.hpp"

namespace kinecal::detail {

/// The source location of a sample; "sample 3" if it was not read from a file.
/// @param index  of the sample, from 0
[[nodiscard]] inline SourceLocation place_of(std::span<const Sample> samples, std::size_t index) {
  const std::string& source = samples[index].source;
  return {source.empty() ? "sample " + std::to_string(index) : source, 0};
}

/// "0.11 mm", "0.3 px".
/// @param unit  of the residual: "m", "px" or "1"
[[nodiscard]] inline std::string residual_text(double value, const std::string& unit) {
  if (unit == "m") return fmt::format("{:.3g} mm", 1e3 * value);
  return unit == "1" ? fmt::format("{:.3g}", value) : fmt::format("{:.3g} {}", value, unit);
}

/// Samples in which something occurs.
struct Occurrences {
  std::size_t count = 0;  ///< number of samples
  std::size_t first = 0;  ///< index of the first one

  /// Counts a sample.
  /// @returns  true if it is the first one
  bool add(std::size_t sample) {
    const bool is_first = count == 0 || sample < first;
    if (is_first) first = sample;
    ++count;
    return is_first;
  }
  /// " (and in 3 more samples)"; empty if it occurs once.
  [[nodiscard]] std::string others() const {
    return count < 2 ? "" : " (and in " + counted(count - 1, "more sample") + ")";
  }
};

}  // namespace kinecal::detail
