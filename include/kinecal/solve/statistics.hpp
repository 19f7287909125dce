// Size of an error block's residuals, in its own unit, without weights and losses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/problem/any_problem.hpp"

namespace kinecal {

/// Sizes of residuals.
struct Statistics {
  double rms = 0.0;     ///< of the features' norms: distances
  double mean = 0.0;    ///< of the features' norms
  double median = 0.0;  ///< of the features' norms
  double max = 0.0;     ///< of the features' norms
};

/// One error block before and after a calibration.
struct BlockStatistics {
  std::string name;        ///< of the error block or prior
  std::string type;        ///< "chain3d_to_chain3d"
  std::string unit;        ///< of the residual: "m", "px" or "1"
  std::int64_t count = 0;  ///< number of features
  Statistics before;       ///< at the initial values
  Statistics after;        ///< at the final values
};

/// Statistics of the residuals of one error block.
/// @param norms  norm of each feature's residual
[[nodiscard]] Statistics statistics_of(std::vector<double> norms);

/// Norms of the unweighted residuals of every feature, for each term of a problem.
[[nodiscard]] std::vector<std::vector<double>> feature_norms(const AnyProblem& problem,
                                                             ParameterValues values);

/// Statistics of all error blocks and priors of a problem, for two sets of parameter values.
[[nodiscard]] std::vector<BlockStatistics> block_statistics(const AnyProblem& problem,
                                                            ParameterValues before,
                                                            ParameterValues after);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/solve/statistics.ipp"
#endif
