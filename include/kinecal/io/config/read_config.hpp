// Reads a calibration from a YAML file in either dialect of robot_calibration.
//
// A file with `ros__parameters` below a top-level key is ROS 2's, any other is ROS 1's.  kinecal's
// own keys, in both: `initial_values` and `bounds` of a step or the file, and `sigma`, `loss` and
// `samples` of an error block.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "kinecal/io/config/config_ros1.hpp"
#include "kinecal/io/config/config_ros2.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/io/yaml/yaml_documents.hpp"

namespace kinecal {

/// The document of a configuration file; null if the file is empty.
/// @throws InputError       if the file cannot be read
/// @throws YAML::Exception  if it is not YAML
[[nodiscard]] inline YAML::Node load_config(const std::string& path, Diagnostics& diagnostics) {
  YAML::Node content;
  for (const YAML::Node& document : load_yaml_documents(read_text_file(path))) {
    if (document.IsNull()) continue;
    if (content.IsNull()) {
      content.reset(document);
    } else {
      diagnostics.error({path, document.Mark().line + 1},
                        "a second document begins here; a configuration is a single one");
    }
  }
  return content;
}

/// Reports keys that belong below `ros__parameters`, which is missing or misspelt.
/// @return  whether there are any
inline bool misses_ros_parameters(const ConfigMap& file) {
  if (const ConfigEntry* steps = file.peek("calibration_steps")) {
    file.error(steps->place, "calibration_steps stands outside of '<node>: ros__parameters:'");
    return true;
  }
  const std::vector<std::string> expected = {"ros__parameters"};
  for (const ConfigEntry& node : file.entries()) {
    if (!node.value.IsMap()) continue;
    for (const auto& pair : node.value) {
      const std::string key = pair.first.IsScalar() ? pair.first.Scalar() : "";
      const std::string meant = did_you_mean(key, expected);
      if (meant.empty()) continue;
      file.error({file.place().file, pair.first.Mark().line + 1},
                 "unknown key '" + key + "' of node '" + node.key + "'" + meant);
      return true;
    }
  }
  return false;
}

/// Reads the file's top-level map in the dialect that it is written in.
inline void read_dialect(ConfigMap& file, ConfigProgress& progress) {
  const std::vector<ConfigEntry> nodes = ros2_nodes(file);
  if (nodes.empty()) {
    if (!misses_ros_parameters(file)) read_ros1(file, progress);
    return;
  }
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    file.error(nodes[i].place, "node '" + nodes[i].key + "' is a second one beside '" +
                                   nodes[0].key + "'; a calibration is a single node");
  }
  for (const ConfigEntry& entry : nodes) file.use(entry.key);
  ConfigMap node(nodes[0].value, nodes[0].place, "node '" + nodes[0].key + "'", file.diagnostics());
  if (auto parameters = node.map(*node.find("ros__parameters"), "")) {
    read_ros2(*parameters, progress);
  }
  node.report_unknown();
  file.report_unknown();
}

/// Adds to one what is in the other, without repeating itself: lists that several steps share are
/// read once for each of them.
inline void add_once(std::vector<std::string>& messages, const std::vector<std::string>& more) {
  std::set<std::string> told;
  for (const std::string& message : more) {
    if (told.insert(message).second) messages.push_back(message);
  }
}

/// Reads a configuration.  All mistakes are gathered; a configuration with errors is incomplete.
/// @param path         YAML file in the ROS 1 or the ROS 2 dialect
/// @param diagnostics  is added errors and warnings, each with "file:line: "
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] inline Config read_config(const std::string& path, Diagnostics& diagnostics) {
  ConfigProgress progress;
  progress.config.place = {path, 0};
  Diagnostics found;
  try {
    const YAML::Node content = load_config(path, found);
    if (content.IsMap()) {
      ConfigMap file(content, {path, 0}, "", found);
      read_dialect(file, progress);
    } else {
      found.error({path, 0}, "the file is " + describe_config(content) + ", not a map");
    }
  } catch (const YAML::Exception& error) {
    throw InputError(Place{path, error.mark.line + 1}.str() + ": " + error.msg);
  }
  add_once(diagnostics.errors, found.errors);
  add_once(diagnostics.warnings, found.warnings);
  return progress.config;
}

}  // namespace kinecal
