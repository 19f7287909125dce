// Held-out error: the residuals of samples that the fit did not use.
//
// The fit without a fold starts from the fit of all samples: one Gauss-Newton step away unless some
// directions are poorly determined.
// Source: Stone, Cross-Validatory Choice and Assessment of Statistical Predictions, 1974.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/linear_fit.hpp"
#include "kinecal/trust/noise/pose_groups.hpp"

namespace kinecal {

/// Fitted and held-out distances of an error block.
struct HeldOutError {
  std::string block;      ///< name of the error block
  std::string unit;       ///< "m", "px" or "1"
  int features = 0;       ///< of all folds
  double fitted = 0.0;    ///< root of the mean squared distance of features, all samples fitted
  double held_out = 0.0;  ///< the same, each feature held out once
  double region = 0.0;    ///< the same, held out with all samples of its region; 0: not computed
};

/// The fold of each sample, 0 to folds - 1.  Poses are dealt in the order of their joint positions, so
/// folds do not depend on the order of samples, each covers all of the workspace, and readings of one pose
/// are in one fold.
[[nodiscard]] std::vector<int> folds_of(std::span<const Sample> samples, const PoseGroups& poses,
                                        int folds);

/// Fitted and held-out error of each error block.
/// @param values  the solution: where `fit` was linearized
/// @param fold    of each sample of the problem, by number
/// @param meter   called after each fold
[[nodiscard]] std::vector<HeldOutError> held_out_errors(AnyEvaluator& evaluator,
                                                        ParameterValues values,
                                                        const LinearFit& fit,
                                                        const std::vector<int>& fold,
                                                        const ProgressMeter& meter = {});

/// Distances of the features of a sensor in each sample while its fold was held out, in the unit of their error block, by the
/// freedom that poses of the samples' own leave.
/// @param values   of all parameters of the table: the solution
/// @param samples  those of the problem, in their order
/// @throws std::domain_error  if the samples without a fold determine nothing
[[nodiscard]] std::vector<std::vector<double>> held_out_distances(
    const AnyProblem& problem, const FreeSet& free, ParameterValues values,
    std::span<const Sample> samples, const std::string& sensor, int folds = 5);

}  // namespace kinecal
