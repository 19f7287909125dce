// The procedure of calibrate_and_judge.hpp for samples in shards, of which few are in memory at a time.
//
// Solution, +- and noise are sums over all samples; a shard is read again for each of them, unless all samples are few.  What
// needs samples at once, such as held-out errors and changes during the recording, is that of a draw of the samples.  A
// shard whose residuals are much larger than those of most is named.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "kinecal/trust/calibrate_and_judge.hpp"

namespace kinecal {

/// A calibration whose samples come in shards.
struct ShardedCalibration {
  Calibration& calibration;         ///< of the draw: its terms, sigmas and samples
  std::span<const Sample> samples;  ///< of the draw, in their order
  /// That of the draw: where the solution starts, and what needs samples at once; nullptr: initial values, and that is
  /// left out.
  const JudgedResult* drawn = nullptr;
  std::vector<std::string> names = {};  ///< of the shards, for messages: their files
  std::int64_t num_samples = 0;         ///< of all shards
  std::vector<std::int64_t> num_residuals =
      {};                          ///< of each step, in all shards; a prior counts once per sample
  std::vector<FreeSet> free = {};  ///< of each step: what the samples of any shard determine
  std::function<std::vector<Sample>(int shard)> read = {};  ///< the samples of a shard
  ShardExchange exchange = {};  ///< empty: all are computed here, one after another
};

/// Calibrates and judges samples in shards.
/// @param calibration  in: see above; out: its steps have the sigmas that were estimated
/// @param options      threads, iterations, doubts; the others have no effect
[[nodiscard]] JudgedResult calibrate_and_judge(const ShardedCalibration& calibration,
                                               const ProcedureOptions& options = {});

}  // namespace kinecal
