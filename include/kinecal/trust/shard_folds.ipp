// Lenses that fold over, of samples in shards: for judge_shards.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "kinecal/trust/folded_lens.hpp"

namespace kinecal::detail {

/// Numbers of each sensor: where its lens folds over, the farthest corner of its image and the farthest feature.
[[nodiscard]] inline std::vector<double> packed(const std::vector<FoldedLens>& folded,
                                                const std::vector<MountedSensor>& sensors) {
  std::vector<double> all;
  for (const MountedSensor& mounted : sensors) {
    FoldedLens of{mounted.mount().name, HUGE_VAL};
    for (const FoldedLens& fold : folded) {
      if (fold.sensor == of.sensor) of = fold;
    }
    all.insert(all.end(), {of.radius, of.corner, of.farthest});
  }
  return all;
}

/// folded_lenses() of the samples of all shards.
/// @param samples_of  reads the samples of a shard: only where a lens is free
[[nodiscard]] inline std::vector<FoldedLens> shard_folds(
    const Shards& shards, const FreeSet& free, ParameterValues values,
    const std::function<std::vector<Sample>(int shard)>& samples_of) {
  const AnyProblem& problem = *shards.problem;
  const std::vector<MountedSensor>& sensors = problem.sensors();
  const bool frees = std::any_of(sensors.begin(), sensors.end(),
                                 [&](const MountedSensor& one) { return frees_lens(one, free); });
  if (!frees) return {};
  const auto numbers_of = [&](int shard) {
    return packed(folded_lenses(problem, free, values, samples_of(shard)), sensors);
  };
  std::vector<FoldedLens> folded;
  for (const MountedSensor& one : sensors) folded.push_back({one.mount().name, HUGE_VAL});
  for (const auto& of : numbers_of_shards(shards, name_at("folds", free, values), numbers_of)) {
    for (std::size_t s = 0; s < folded.size(); ++s) {
      folded[s].radius = std::min(folded[s].radius, of.at(3 * s));
      folded[s].corner = std::max(folded[s].corner, of.at(3 * s + 1));
      folded[s].farthest = std::max(folded[s].farthest, of.at(3 * s + 2));
    }
  }
  std::erase_if(folded, [](const FoldedLens& fold) { return !std::isfinite(fold.radius); });
  return folded;
}

}  // namespace kinecal::detail
