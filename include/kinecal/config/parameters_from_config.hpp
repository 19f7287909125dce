// Builds the parameter table of a configuration, and checks every name against the robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/configured_sensor.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// The own parameters of an error block; empty if its numbers are impossible.
[[nodiscard]] std::vector<ParameterInfo> own_parameters(const BlockConfig& block);

/// Names of the frames in which features were recorded, without a leading slash.
[[nodiscard]] std::set<std::string> feature_frames(std::span<const Sample> samples);

/// Names of all frames that are free in some step.
[[nodiscard]] std::set<std::string> frames_of(const Config& config);

/// The table of all parameters named in some step: all six of each frame, all of each sensor and
/// error block.
/// @param samples      may be empty; then frames of features are unknown and not checked
/// @param diagnostics  receives errors and warnings, each with "file:line: "
[[nodiscard]] ParameterTable parameters_from(const Config& config, const Robot& robot,
                                             std::span<const Sample> samples,
                                             Diagnostics& diagnostics);

/// The values set before a step starts: initial values of parameters and of the free axes of
/// of frames.
/// @return  indices in the table, and values
[[nodiscard]] std::vector<std::pair<int, double>> initial_assignments(const StepConfig& step,
                                                                      const ParameterTable& table);

}  // namespace kinecal::detail
