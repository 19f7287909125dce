// YAML files of a single document: configurations, poses, csv mappings.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"

namespace kinecal {

namespace detail {

/// The document of a YAML file with a single one; null if the file is empty.
/// @param diagnostics  receives an error for each further document
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] YamlNode load_config(const std::string& path, Diagnostics& diagnostics);

/// The same for the text of a file.
/// @param path  of the file, for messages
[[nodiscard]] YamlNode parse_config_text(const std::string& text, const std::string& path,
                                         Diagnostics& diagnostics);

}  // namespace detail

}  // namespace kinecal
