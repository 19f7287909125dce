// The parameter table of a configuration, with every name checked against the robot.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/parameters/parameter_table.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// The type of a model.  A model of unknown type counts as a camera3d: this type has the most
/// parameters, so a name among them is not reported as well.
[[nodiscard]] const SensorEntry& sensor_entry(const ModelConfig& model);

/// Where the sensor of a model is, and its names.
[[nodiscard]] Mount mount_from(const ModelConfig& model);

/// The own parameters of an error block; none if its numbers are impossible.
[[nodiscard]] std::vector<ParameterInfo> own_parameters(const BlockConfig& block);

/// Names of all frames that are free in some step.
[[nodiscard]] std::set<std::string> frames_of(const Config& config);

/// The table of all parameters that some step names: all six of each frame, all of each sensor and
/// error block.
/// @param samples      may be empty; then frames of features are unknown and not checked
/// @param diagnostics  receives errors and warnings, each with "file:line: "
[[nodiscard]] ParameterTable parameters_from(const Config& config, const Robot& robot,
                                             std::span<const Sample> samples,
                                             Diagnostics& diagnostics);

/// The values that a step sets before it starts: initial values of parameters and of the free axes
/// of frames.
/// @return  indices in the table, and values
[[nodiscard]] std::vector<std::pair<int, double>> initial_assignments(const StepConfig& step,
                                                                      const ParameterTable& table);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/parameters_from_config.ipp"
#endif
