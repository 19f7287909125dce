// A configuration in the ROS 2 dialect: <node>: ros__parameters: with the steps that
// `calibration_steps` names, in its order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "kinecal/io/config/config_step.hpp"

namespace kinecal {

/// The nodes of a file: the top-level keys with ros__parameters below.
[[nodiscard]] inline std::vector<ConfigEntry> ros2_nodes(const ConfigMap& file) {
  std::vector<ConfigEntry> nodes;
  for (const ConfigEntry& entry : file.entries()) {
    if (!entry.value.IsMap()) continue;
    for (const auto& pair : entry.value) {
      if (pair.first.IsScalar() && pair.first.Scalar() == "ros__parameters") {
        nodes.push_back(entry);
        break;
      }
    }
  }
  return nodes;
}

/// The entries of `calibration_steps`, each with the name as its key, without those that are none.
[[nodiscard]] inline std::vector<ConfigEntry> ros2_step_names(ConfigMap& parameters) {
  std::vector<ConfigEntry> names;
  for (const ConfigEntry& element : parameters.list("calibration_steps")) {
    const auto name = config_text(element.value);
    if (!name) {
      parameters.error(element.place, "calibration_steps: " + describe_config(element.value) +
                                          " is not a name of a step");
      continue;
    }
    const auto has_name = [&](const ConfigEntry& entry) { return entry.key == *name; };
    const auto first = std::find_if(names.begin(), names.end(), has_name);
    if (first == names.end()) {
      names.push_back({*name, element.value, element.place});
    } else {
      parameters.error(element.place, "step '" + *name + "' occurs twice; the first is in line " +
                                          std::to_string(first->place.line));
    }
  }
  return names;
}

inline void read_ros2_steps(ConfigMap& parameters, int max_num_iterations,
                            ConfigProgress& progress) {
  const std::vector<ConfigEntry> names = ros2_step_names(parameters);
  std::set<std::string> others;  // maps that are no step, one of which may be the one meant
  for (const ConfigEntry& entry : parameters.entries()) {
    if (entry.value.IsMap()) others.insert(entry.key);
  }
  for (const ConfigEntry& name : names) others.erase(name.key);
  for (const ConfigEntry& name : names) {
    if (const ConfigEntry* entry = parameters.use(name.key)) {
      auto step = parameters.map(*entry, "step '" + name.key + "'");
      if (step) read_step(*step, FindRos2Items(), name.key, max_num_iterations, progress);
      continue;
    }
    parameters.error(name.place, "step '" + name.key + "' has no map '" + name.key +
                                     "' beside calibration_steps" + did_you_mean(name.key, others));
    if (const auto meant = nearest_name(name.key, others)) parameters.use(*meant);
  }
}

/// @param parameters  what stands under ros__parameters
inline void read_ros2(ConfigMap& parameters, ConfigProgress& progress) {
  parameters.ignore({"use_sim_time"});
  const int iterations = read_settings(parameters, StepConfig{}.max_num_iterations, progress);
  require_items(parameters, {"calibration_steps", "step", ""});
  read_ros2_steps(parameters, iterations, progress);
  share_values(parameters, progress);
  parameters.report_unknown();
}

}  // namespace kinecal
