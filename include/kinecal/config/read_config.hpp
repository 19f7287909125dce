// Reads a calibration from a YAML file in either dialect of robot_calibration.
//
// A file with `ros__parameters` below a top-level key is in the ROS 2 dialect, any other file in
// the ROS 1 dialect.  Only kinecal reads, in both: `initial_values` and `bounds` of a step or the
// file, and `sigma`, `loss` and `samples` of an error block.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"

namespace kinecal {

/// Reads a configuration.  It collects all errors; with errors, the configuration is incomplete.
/// @param path         YAML file in the ROS 1 or the ROS 2 dialect
/// @param diagnostics  receives errors and warnings, each with "file:line: "
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] Config read_config(const std::string& path, Diagnostics& diagnostics);

/// Reads a configuration from its text.
/// @param path          of the text's file, for messages
/// @param nothing_free  whether a step may free nothing, as for a search
/// @throws InputError  "path:line: ..." if it is not YAML
[[nodiscard]] Config parse_config(const std::string& text, const std::string& path,
                                  Diagnostics& diagnostics,
                                  NothingFree nothing_free = NothingFree::is_error);

}  // namespace kinecal
