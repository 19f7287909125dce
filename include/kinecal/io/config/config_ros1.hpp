// A configuration in the ROS 1 dialect: the file's own keys are the one step, or there are several
// under `cal_steps`.
//
// They run in alphabetical order of their names, as ROS keeps them.  A list that a step leaves out
// is that of the step before it, and of the file's own keys for the first: robot_calibration reads
// every step over the last one.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/config/config_step.hpp"

namespace kinecal {

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
                  {"models", "free_params", "free_frames", "error_blocks"});
    if (maps.empty()) step->inherit(file, {"free_frames_initial_values"});
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

}  // namespace kinecal
