// Checks that there are enough samples for the parameters, and that every observation is used.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::detail {

/// Error: a step has more free parameters than 4/5 of its residuals.  Doubt: than half of them, or
/// than half of six per sample: a pose has six numbers, however many features show it.
/// @param distinct  number of different samples; copies do not count
void check_enough_samples(const Config& config, const Calibration& calibration,
                          std::size_t distinct, Diagnostics& diagnostics);

/// Warning: observations without a usable feature, and samples that no error block uses.
void check_dropped_observations(const Config& config, std::span<const Sample> samples,
                                Diagnostics& diagnostics);

}  // namespace kinecal::detail
