// Poses in which samples are to be taken, as robot_calibration's YAML has them:
//
//   - {joints: [shoulder_pan_joint, ...], positions: [0.1, ...], features: [led_finder]}
//
// `features` names the finders that look there; without any, all do.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/config/config_map.hpp"
#include "kinecal/io/config/read_config.hpp"
#include "kinecal/io/yaml/yaml_text.hpp"

namespace kinecal {

/// One pose, and what is looked for there.
struct CapturePose {
  std::vector<std::string> joint_names;
  std::vector<double> positions;  ///< radians or metres, in the order of the names
  std::vector<std::string> features;

  friend bool operator==(const CapturePose&, const CapturePose&) = default;
};

namespace detail {

[[nodiscard]] inline std::vector<std::string> read_pose_names(ConfigMap& map,
                                                              const std::string& key) {
  std::vector<std::string> names;
  for (const ConfigEntry& element : map.list(key)) {
    const auto name = config_text(element.value);
    if (!name) {
      map.error(element.place, key + ": " + describe_config(element.value) + " is not a name");
    }
    names.push_back(name.value_or(""));
  }
  return names;
}

[[nodiscard]] inline CapturePose read_pose(ConfigMap& map) {
  CapturePose pose;
  pose.joint_names = read_pose_names(map, "joints");
  for (const ConfigEntry& element : map.list("positions")) {
    const auto number = config_number(element.value);
    if (!number || !std::isfinite(*number)) {
      map.error(element.place,
                "positions: " + describe_config(element.value) + " is not a finite number");
    }
    pose.positions.push_back(number.value_or(0.0));
  }
  pose.features = read_pose_names(map, "features");
  for (const char* key : {"joints", "positions"}) {
    if (map.peek(key) == nullptr) map.error(map.place(), std::string(key) + " is missing");
  }
  if (pose.joint_names.size() != pose.positions.size()) {
    map.error(map.place(), fmt::format("{} joints but {} positions", pose.joint_names.size(),
                                       pose.positions.size()));
  }
  for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (pose.joint_names[i] == pose.joint_names[j]) {
        map.error(map.place(), "joint '" + pose.joint_names[i] + "' occurs twice");
      }
    }
  }
  map.report_unknown();
  return pose;
}

}  // namespace detail

/// Whether a YAML file holds poses: it is a list, while samples begin with a key.
[[nodiscard]] inline bool is_poses_yaml(const std::string& path) {
  std::ifstream file(path);
  bool is_first = true;
  for (std::string line; std::getline(file, line);) {
    if (std::exchange(is_first, false) && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#' || line[first] == '%') continue;
    if (line.starts_with("---")) continue;
    return line[first] == '-' || line[first] == '[';
  }
  return false;
}

/// Reads poses.  All mistakes are gathered; with errors the poses are incomplete.
/// @param diagnostics  is added errors and warnings, each with "file:line: "
/// @throws InputError  "file:line: ..." if the file cannot be read or is not YAML
[[nodiscard]] inline std::vector<CapturePose> read_poses_yaml(const std::string& path,
                                                              Diagnostics& diagnostics) {
  std::vector<CapturePose> poses;
  try {
    const YAML::Node content = load_config(path, diagnostics);
    if (!content.IsSequence()) {
      diagnostics.error({path, 0}, "the file is " + describe_config(content) +
                                       ", not a list of {joints: [], positions: [], features: []}");
      return poses;
    }
    for (const auto& element : content) {
      const Place place{path, element.Mark().line + 1};
      const std::string subject = fmt::format("pose {}", poses.size() + 1);
      if (!element.IsMap()) {
        diagnostics.error(place, subject + " is " + describe_config(element) + ", not a map");
        continue;
      }
      ConfigMap map(element, place, subject, diagnostics);
      poses.push_back(detail::read_pose(map));
    }
  } catch (const YAML::Exception& error) {
    throw InputError(Place{path, error.mark.line + 1}.str() + ": " + error.msg);
  }
  return poses;
}

/// Writes poses as read_poses_yaml() reads them, to the last bit of every position.
/// @throws std::invalid_argument  if a pose has more or fewer positions than joint names; what
///                                stands before it has then been written
inline void write_poses_yaml(std::ostream& out, const std::vector<CapturePose>& poses) {
  const auto names = [](const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& name : all) text += (text.empty() ? "" : ", ") + name_to_yaml(name);
    return text;
  };
  if (poses.empty()) out << "[]\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const CapturePose& pose = poses[i];
    if (pose.joint_names.size() != pose.positions.size()) {
      throw std::invalid_argument(fmt::format("pose {}: {} joints but {} positions", i + 1,
                                              pose.joint_names.size(), pose.positions.size()));
    }
    std::string positions;
    for (const double q : pose.positions) {
      positions += (positions.empty() ? "" : ", ") + number_to_yaml(q);
    }
    out << fmt::format("- joints: [{}]\n  positions: [{}]\n  features: [{}]\n",
                       names(pose.joint_names), positions, names(pose.features));
  }
}

}  // namespace kinecal
