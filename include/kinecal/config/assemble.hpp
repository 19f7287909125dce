// Builds the calibration: configuration + robot + samples -> problems that can be solved.
//
// Every error is reported with its place.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// Builds the problems of all steps.
/// @param samples  may be empty: then only the configuration and the robot are checked
[[nodiscard]] Calibration assemble(const Config& config, const Robot& robot,
                                   std::span<const Sample> samples, Diagnostics& diagnostics);

/// A step's problem without samples: its sensors and error blocks.
/// @param table    all parameters, as in Calibration::table
/// @param samples  decide which samples a plane block takes
/// @throws InputError  if sensors or blocks do not fit the robot
[[nodiscard]] std::unique_ptr<AnyProblem> empty_problem(const Config& config,
                                                        const StepConfig& step, const Robot& robot,
                                                        const ParameterTable& table,
                                                        std::span<const Sample> samples);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/assemble.ipp"
#endif
