// Assembles the calibration: configuration + robot + samples -> problems ready to solve.
//
// Every error names its source location.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// Builds the problems of all steps.
/// @param samples  may be empty: then checks only the configuration and the robot
[[nodiscard]] Calibration assemble(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples, Diagnostics& diagnostics);

/// The sigma of an error block: that of its features, if each has one of its own, or if the block has none; else the block's.
/// It is that of a feature of mean weight, 1 / sigma^2, so that weighted residuals become residuals in their unit again.
[[nodiscard]] std::optional<double> stated_sigma(const BlockConfig& block, const StepConfig& step,
                                                 std::span<const Sample> samples);

/// A calibration of other samples, assembled already: the same sensors in the same order, other numbers.
/// @param samples  as many as those of `assembled`
/// @throws SampleError  naming the sample and what is missing or wrong in it
/// @throws std::invalid_argument  if they are not as many
[[nodiscard]] Calibration with_samples(const Calibration& assembled,
                                       std::span<const Sample> samples);

}  // namespace kinecal
