// How well the result of samples in shards is known.
//
//   C = A^-1 B A^-1      A = sum over features of the cost's Hessian + P      B = sum g_s g_s^T + P
//
// with g_s the gradient of all features of sample s, and P the priors.  This supposes nothing of the noise but
// that samples err independently: so many samples say themselves how much they vary, and features that
// err together, blocks of unlike noise and losses are all in it.  It takes many more samples than
// parameters.
// Source: Huber, Robust Statistics, 1981, 6.3; Liang, Zeger, Biometrika 73, 1986, for g_s.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/solve/shards.hpp"
#include "kinecal/trust/plain_matrix.hpp"

namespace kinecal {

/// How far apart an error block's sensors are.
struct ShardBlock {
  std::string name, unit;   ///< of the error block; of its residuals
  double features = 0.0;    ///< number of them
  double rms_before = 0.0;  ///< of a residual's components, without weights and losses
  double rms_after = 0.0;   ///< the same at the result
};

/// What is known of a result.
struct ShardUncertainty {
  int determined = 0;              ///< directions that samples and priors determine
  PlainMatrix covariance;          ///< (free x free); zero along what nothing determines
  std::vector<double> deviation;   ///< of each free parameter; infinite if it is not determined
  std::vector<ShardBlock> blocks;  ///< of each error block
  std::vector<double> misfits;  ///< of each shard: RMS of its weighted residuals, losses included
};

/// @param before  values of all parameters of the table at the start
/// @param after   the same at the solution
[[nodiscard]] ShardUncertainty shard_uncertainty(const Shards& shards, const FreeSet& free,
                                                 std::span<const double> before,
                                                 std::span<const double> after, int threads = 0);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/trust/shard_uncertainty.ipp"
#endif
