// The two dialects of configurations.
//
// ROS 1: the top-level keys are the only step, or `cal_steps` has several.  These run in
// alphabetical order, as ROS stores them.  A step without one of the lists inherits it from the
// previous step, the first step from the top-level keys: robot_calibration reads each step on top
// of the last one.  So each step also starts its free frames at the initial values.
//
// ROS 2: `<node>: ros__parameters:` with the steps listed in `calibration_steps`, in this order.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config_step.ipp"
#include "kinecal/config/ros2_nodes.ipp"

namespace kinecal::detail {

inline void read_ros1_steps(ConfigMap& file, ConfigMap& steps, ConfigProgress& progress) {
  const int max_num_iterations = read_settings(file, StepConfig{}.max_num_iterations, progress);
  std::set<std::string> names;
  for (const ConfigEntry& entry : steps.entries()) names.insert(entry.key);
  if (names.empty()) file.error(steps.place(), "cal_steps has no steps");
  std::vector<ConfigMap> maps;
  for (const std::string& name : names) {
    auto step = steps.map(*steps.use(name), "step '" + name + "'");
    if (!step) continue;
    step->inherit(maps.empty() ? file : maps.back(),
                  {"models", "free_params", "free_frames", "fixed_frames",
                   "free_frames_initial_values", "error_blocks"});
    read_step(*step, find_ros1_items, name, max_num_iterations, progress);
    maps.push_back(std::move(*step));
  }
  share_values(file, progress);
}

inline void read_ros1(ConfigMap& file, ConfigProgress& progress) {
  const ConfigEntry* entry = file.find("cal_steps");
  if (entry == nullptr) {
    read_step(file, find_ros1_items, "calibrate", StepConfig{}.max_num_iterations, progress);
    return;
  }
  if (auto steps = file.map(*entry, "cal_steps")) read_ros1_steps(file, *steps, progress);
  file.report_unknown();
}

/// The names in `calibration_steps`, each as the key of its entry.
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
  std::set<std::string> others;  // maps that are not listed as steps; one may be a misspelt step
  for (const ConfigEntry& entry : parameters.entries()) {
    if (entry.value.is_map()) others.insert(entry.key);
  }
  for (const ConfigEntry& name : names) others.erase(name.key);
  for (const ConfigEntry& name : names) {
    if (const ConfigEntry* entry = parameters.use(name.key)) {
      auto step = parameters.map(*entry, "step '" + name.key + "'");
      if (step) read_step(*step, FindRos2Items(), name.key, max_num_iterations, progress);
      continue;
    }
    const std::string meant = parameters.did_you_mean(name.key, others);
    parameters.error(name.place, "step '" + name.key + "' has no map '" + name.key +
                                     "' beside calibration_steps" + meant);
    if (!meant.empty()) parameters.use(*nearest_name(name.key, others));
  }
}

/// @param parameters  the map under ros__parameters
inline void read_ros2(ConfigMap& parameters, ConfigProgress& progress) {
  parameters.ignore({"use_sim_time", "start_type_description_service"});  // of every node
  // Of the capture, which may be in the same file.
  parameters.ignore({"duration", "velocity_factor", "settling_timeout", "qos_overrides"});
  for (const char* list : {"chains", "features"}) {
    for (const ConfigEntry& element : parameters.list(list)) {
      if (const auto name = config_text(element.value)) parameters.use(*name);
    }
  }
  const int iterations = read_settings(parameters, StepConfig{}.max_num_iterations, progress);
  require_items(parameters, {"calibration_steps", "step", ""});
  read_ros2_steps(parameters, iterations, progress);
  share_values(parameters, progress);
  parameters.report_unknown();
}

/// Reports a `ros__parameters` that is missing above calibration_steps, or misspelt.
/// @return  true if so
inline bool misses_ros_parameters(const ConfigMap& file) {
  if (const ConfigEntry* steps = file.peek("calibration_steps")) {
    file.error(steps->place, "calibration_steps stands outside of '<node>: ros__parameters:'");
    return true;
  }
  const std::vector<std::string> expected = {"ros__parameters"};
  for (const ConfigEntry& node : file.entries()) {
    for (const YamlNode& key : node.value.keys) {
      const std::string meant = did_you_mean(key.text, expected);
      if (meant.empty()) continue;
      file.error({file.place().file, key.line},
                 "unknown key '" + key.text + "' of node '" + node.key + "'" + meant);
      return true;
    }
  }
  return false;
}

/// Reports keys that are one level too deep, below the name of a node or of a namespace.
/// @return  true if so
inline bool is_too_deep(const ConfigMap& file) {
  const std::vector<std::string> known = {"cal_steps", "models", "free_params", "free_frames",
                                          "error_blocks"};
  const auto stands_in = [](const auto& map) {
    return [&map](const std::string& key) { return map(key) != nullptr; };
  };
  const auto at_top = [&](const std::string& key) { return file.peek(key); };
  if (std::any_of(known.begin(), known.end(), stands_in(at_top))) return false;
  for (const ConfigEntry& entry : file.entries()) {
    const std::string below = "below '" + entry.key + "'";
    const auto deeper = [&](const std::string& key) { return entry.value.find(key); };
    if (deeper("calibration_steps") != nullptr) {
      file.error(entry.place,
                 "calibration_steps is " + below + "; add 'ros__parameters:' between the two");
    } else if (std::any_of(known.begin(), known.end(), stands_in(deeper))) {
      file.error(entry.place, "the keys are " + below + "; move them to the top");
    } else {
      continue;
    }
    return true;
  }
  return false;
}

/// Reads the file's top-level map in its dialect: ROS 2 with `ros__parameters`, ROS 1 without.
/// @param content  the map
inline void read_dialect(const YamlNode& content, ConfigMap& file, ConfigProgress& progress) {
  const std::vector<ConfigEntry> nodes = ros2_nodes(content, file.place().file);
  if (nodes.empty()) {
    if (!misses_ros_parameters(file) && !is_too_deep(file)) read_ros1(file, progress);
    return;
  }
  for (const ConfigEntry& entry : nodes) file.use(entry.key.substr(0, entry.key.find('/')));
  for (const ConfigEntry& entry : nodes) file.use(entry.key);
  const ConfigEntry* chosen = choose_node(nodes, "calibration_steps", file.diagnostics());
  if (chosen == nullptr) return;
  ConfigMap node(chosen->value, chosen->place, "node '" + chosen->key + "'", file.diagnostics());
  if (auto parameters = node.map(*node.find("ros__parameters"), "")) {
    read_ros2(*parameters, progress);
  }
  node.report_unknown();
  file.report_unknown();
}

}  // namespace kinecal::detail
