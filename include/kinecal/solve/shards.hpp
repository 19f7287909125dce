// Solves with more samples than fit into memory, or with several processes.
//
// Cost, gradient and Hessian are sums over samples, so samples can come in shards: each is read,
// summed and released before the next.  A shard's sums are a few thousand numbers, whatever its
// size; processes that share the work exchange these.  They are added in the order of the shards,
// so the result is the same, bit for bit, for any number of processes.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "kinecal/evaluation/any_evaluator.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"
#include "kinecal/solve/solve.hpp"
#include "kinecal/solve/spectrum.hpp"

namespace kinecal {

/// Computes numbers of a shard.
using NumbersOfShard = std::function<std::vector<double>(int shard)>;

/// Returns the numbers of all shards, in order: computes them or gets them from other processes.
/// @param what  identifies the numbers and the values at which they are taken: bytes, the same in
///              all processes
using ShardExchange = std::function<std::vector<std::vector<double>>(
    const std::string& what, const NumbersOfShard& numbers_of)>;

/// The samples of a problem, in shards.
struct Shards {
  const AnyProblem* problem = nullptr;  ///< without samples: parameters, sensors and terms
  int count = 0;                        ///< number of shards
  std::int64_t samples = 0;             ///< of all shards
  std::int64_t num_residuals = 0;       ///< of all features; a prior counts once per sample
  /// The problem with the samples of a shard; the reader decides whether to keep it or read it
  /// again.
  std::function<std::shared_ptr<const AnyProblem>(int shard)> read = {};
  ShardExchange exchange = {};  ///< empty: all are computed here, one after another
};

/// Numbers of all shards: those of the exchange, or computed here.
[[nodiscard]] std::vector<std::vector<double>> numbers_of_shards(const Shards& shards,
                                                                 const std::string& what,
                                                                 const NumbersOfShard& numbers_of);

/// An evaluator of all shards.  Its problem has no samples.
/// @param shards   must outlive it
/// @param threads  that share a shard
[[nodiscard]] std::unique_ptr<AnyEvaluator> shard_evaluator(const Shards& shards,
                                                            const FreeSet& free, int threads = 0);

/// Like solve(), hold_undetermined() and wrap_angles() with all samples.
/// @param values     of all parameters of the table: in: where to start; out: where it ended.
///                   Unchanged if the result is not usable
/// @param reference  values that undetermined directions return to
[[nodiscard]] StepResult solve_shards(const Shards& shards, const FreeSet& free,
                                      std::vector<double>& values, ParameterValues reference,
                                      const SolveOptions& options = {});

namespace detail {

/// Identifies numbers at some values: the name, then the values' bytes.
[[nodiscard]] std::string name_at(const std::string& what, const FreeSet& free,
                                  ParameterValues values);

/// The information of all shards' samples.
[[nodiscard]] SampleInformation shard_information(const Shards& shards, const FreeSet& free,
                                                  ParameterValues values);

}  // namespace detail

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/shards.ipp"
#endif
