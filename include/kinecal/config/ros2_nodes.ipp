// The nodes of a parameter file of ROS 2: maps with ros__parameters, also below namespaces.
//
// One file may hold the parameters of several nodes; each reads its own.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "kinecal/files/yaml/config_map.hpp"

namespace kinecal::detail {

/// Adds the nodes of a map, by their full names: "fetch/robot_calibration".
inline void add_ros2_nodes(const YamlNode& map, const std::string& above, const std::string& file,
                           std::vector<ConfigEntry>& nodes) {
  constexpr std::size_t kMostNodes = 100;  // of a hostile file
  for (std::size_t i = 0; i < map.keys.size() && nodes.size() < kMostNodes; ++i) {
    if (!map.items[i].is_map() || !map.keys[i].is_scalar()) continue;
    const std::string name = above + map.keys[i].text;
    if (map.items[i].find("ros__parameters") != nullptr) {
      nodes.push_back({name, map.items[i], {file, map.keys[i].line}});
    } else if (std::count(name.begin(), name.end(), '/') < 4) {
      add_ros2_nodes(map.items[i], name + "/", file, nodes);
    }
  }
}

/// The nodes of a file.
[[nodiscard]] inline std::vector<ConfigEntry> ros2_nodes(const YamlNode& content,
                                                         const std::string& file) {
  std::vector<ConfigEntry> nodes;
  add_ros2_nodes(content, "", file, nodes);
  return nodes;
}

/// The node that has a parameter, and a warning for each of the others; the first one if none has
/// it; nullptr, and an error, if several have it and none of them is robot_calibration.
/// @param nodes  at least one
[[nodiscard]] inline const ConfigEntry* choose_node(const std::vector<ConfigEntry>& nodes,
                                                    const std::string& parameter,
                                                    Diagnostics& diagnostics) {
  std::vector<const ConfigEntry*> fitting;
  for (const ConfigEntry& node : nodes) {
    if (node.value.find("ros__parameters")->find(parameter) != nullptr) fitting.push_back(&node);
  }
  const ConfigEntry* chosen = fitting.empty() ? &nodes.front() : fitting.front();
  if (fitting.size() > 1) {
    const auto upstream = std::find_if(fitting.begin(), fitting.end(), [](const ConfigEntry* node) {
      return node->key == "robot_calibration" || node->key.ends_with("/robot_calibration");
    });
    if (upstream == fitting.end()) {
      diagnostics.error(fitting[1]->place, "two nodes have " + parameter + ", '" + fitting[0]->key +
                                               "' and '" + fitting[1]->key + "'; keep one");
      return nullptr;
    }
    chosen = *upstream;
  }
  for (const ConfigEntry& node : nodes) {
    if (&node == chosen) continue;
    diagnostics.warning(node.place,
                        "node '" + node.key + "' is ignored; '" + chosen->key + "' is used");
  }
  return chosen;
}

}  // namespace kinecal::detail
