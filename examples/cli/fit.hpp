// Calibrating, judging, and leaving out samples that do not fit the others.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/report/findings.hpp"

namespace kinecal::cli {

/// A calibration and what was found.
struct Fit {
  Calibration calibration;
  std::vector<Sample> samples;  ///< those of the calibration
  Findings findings;
};

/// Calibrates without the samples that the options exclude, and again without those that do not fit the
/// others, until there are none (trust/ruined.hpp).
/// @throws InputError  if a sample to exclude does not exist, or too few are left
[[nodiscard]] Fit fit(const Input& input, const CalibrateOptions& options, const Progress& progress,
                      const SolveOptions& solving);

/// Error blocks without a sigma for which an estimate matters: those with a loss, whose scale is in
/// sigmas, and several of a step, which are weighed against each other.
[[nodiscard]] std::vector<BlockConfig*> blocks_to_estimate(Config& config);

/// Gives these blocks the noise that their residuals show in place of a sigma.
/// @returns  whether one changed by more than 1 %
[[nodiscard]] bool take_estimates(const Findings& findings,
                                  const std::vector<BlockConfig*>& blocks);

/// Adds offsets that cannot be, and mistakes that explain a bad fit, to its reasons: with them it is not
/// to be used.
void add_causes(const Input& input, Fit& fitted);

}  // namespace kinecal::cli
