// Assembles the calibration: configuration + robot + samples -> problems ready to solve.
//
// Every error names its source location.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// Builds the problems of all steps.
/// @param samples  may be empty: then checks only the configuration and the robot
[[nodiscard]] Calibration assemble(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples, Diagnostics& diagnostics);

}  // namespace kinecal
