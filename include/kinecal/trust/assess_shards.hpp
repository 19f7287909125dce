// Assesses the result of samples in shards.
//
//   C = A^-1 B A^-1      A = sum over features of the cost's Hessian + P      B = sum g_s g_s^T + P
//
// with g_s the gradient of all features of sample s, and P the priors.  The only assumption about
// the noise is that samples err independently: so many samples show directly how much they vary.
// This covers features that err together, error blocks with different noise, and losses.  It takes
// many more samples than parameters.
// Source: Huber, Robust Statistics, 1981, 6.3; Liang, Zeger, Biometrika 73, 1986, for g_s.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal {

/// A feature that weighs as much as many others together.
struct FarFeature {
  int shard = 0;
  std::string block;      ///< name of its error block
  std::string unit;       ///< of its residual: "m", "px" or "1"
  double distance = 0.0;  ///< in `unit`
  double times = 0.0;     ///< the same over the robust noise of the block
};

/// The quality of a result.
struct ShardAssessment {
  /// Lacks captures, held-out error and changes during the recording: these need all samples at
  /// once.
  Assessment assessment;
  std::vector<BlockStatistics> blocks;  ///< of error blocks; medians to 0.3 %
  /// Of each shard: RMS of its weighted residuals, losses included, by the degrees of freedom that its samples' own poses
  /// leave.
  std::vector<double> misfits;
  /// Of each shard and error block at most one: 20 times the noise or more, and a twentieth of all squares or more.
  std::vector<FarFeature> far;
  std::vector<std::pair<int, int>>
      copies;  ///< shards with the same samples as an earlier one, and that one
};

/// @param before   values of all parameters of the table at the start
/// @param after    the same at the solution
/// @param drawn    the problem with some samples of all shards: the compared pose is evaluated at them
/// @param samples  these, in its order
[[nodiscard]] ShardAssessment assess_shards(const Shards& shards, const FreeSet& free,
                                            ParameterValues before, ParameterValues after,
                                            const AnyProblem& drawn,
                                            std::span<const Sample> samples);

}  // namespace kinecal
