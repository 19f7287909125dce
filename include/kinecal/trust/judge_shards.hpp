// The whole procedure of calibrate_and_judge.hpp for samples in shards, of which few are in memory at a time.
//
// A shard's samples are read again for each evaluation, unless all of them are few.  What needs all samples
// at once is left out: held-out errors, bad samples, changes during the recording.  A shard whose
// residuals are much larger than those of most is named in their place.
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
  Calibration first;  ///< of the samples of the first shard, where the solution starts
  std::span<const Sample> samples;  ///< of the first shard
  std::vector<std::string> names;   ///< of the shards, for messages: their files
  std::int64_t num_samples = 0;     ///< of all shards
  std::vector<std::int64_t>
      num_residuals;          ///< of each step, in all shards; a prior counts once per sample
  std::vector<FreeSet> free;  ///< of each step: what the samples of any shard determine
  std::function<std::vector<Sample>(int shard)> read;  ///< the samples of a shard but the first
  ShardExchange exchange = {};  ///< empty: all are computed here, one after another
};

/// Calibrates and judges samples in shards.
/// @param calibration  in: see above; out: its steps have the sigmas that were estimated
/// @param options      threads, iterations, doubts; the others have no effect
[[nodiscard]] JudgedResult calibrate_and_judge(ShardedCalibration& calibration,
                                               const ProcedureOptions& options = {});

}  // namespace kinecal
