// Warnings about the ids by which error blocks pair features.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/problem/term.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Warns of samples in which the sensors of a term saw different features.
inline void warn_of_disjoint_ids(const Term& term, const BlockConfig& block,
                                 std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::size_t disjoint = 0;
  std::string first;
  for (const Sample& sample : samples) {
    if (!term.pairs_features() || !ids_are_disjoint(sample, block.models)) continue;
    if (disjoint++ == 0) first = sample.source;
  }
  if (disjoint == 0) return;
  diagnostics.warning(
      block.place,
      fmt::format("error block '{}' does not use {} sample{}: its sensors observed no feature of "
                  "the same id; the first is at {}",
                  term.name, disjoint, disjoint == 1 ? "" : "s", first));
}

/// Warns of samples in which some sensors of a term have ids, and others do not.
inline void warn_of_one_sided_ids(const Term& term, const BlockConfig& block,
                                  std::span<const Sample> samples, Diagnostics& diagnostics) {
  if (!term.pairs_features()) return;
  for (const Sample& sample : samples) {
    std::string with, without;
    for (const std::string& model : block.models) {
      const Observation* seen = sample.observation(model);
      if (seen == nullptr || seen->features.empty()) continue;
      (seen->features.front().id ? with : without) = model;
    }
    if (with.empty() || without.empty()) continue;
    diagnostics.warning(
        block.place, fmt::format("error block '{}': features of '{}' have ids, those of '{}' have "
                                 "none, so they are paired by place; the first sample is at {}",
                                 term.name, with, without, sample.source));
    return;
  }
}

}  // namespace kinecal::detail
