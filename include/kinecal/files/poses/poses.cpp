// Definitions of poses.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/poses/poses.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <optional>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/poses/hand_eye_samples.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"

namespace kinecal {
namespace detail {
namespace {

/// "2 joints but 1 position"
[[nodiscard]] std::string names_but_positions(const CapturePose& pose) {
  const std::size_t names = pose.joint_names.size(), positions = pose.positions.size();
  return fmt::format("{} joint{} but {} position{}", names, names == 1 ? "" : "s", positions,
                     positions == 1 ? "" : "s");
}

[[nodiscard]] std::vector<std::string> read_pose_names(ConfigMap& map, const std::string& key) {
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

/// @return  nullopt, and a warning, for joints and positions of different number: robot_calibration
///          leaves such a pose out, too
[[nodiscard]] std::optional<CapturePose> read_pose(ConfigMap& map) {
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
  for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (pose.joint_names[i] == pose.joint_names[j]) {
        map.error(map.place(), "joint '" + pose.joint_names[i] + "' occurs twice");
      }
    }
  }
  map.report_unknown();
  if (pose.joint_names.size() == pose.positions.size()) return pose;
  map.warning(map.place(), names_but_positions(pose) + "; the pose is left out");
  return std::nullopt;
}

}  // namespace
}  // namespace detail

bool is_poses_yaml(const std::string& path) {
  if (!detail::why_no_file(path).empty() || is_hand_eye_samples(path)) return false;
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

std::vector<CapturePose> read_poses_yaml(const std::string& path, Diagnostics& diagnostics) {
  std::vector<CapturePose> poses;
  const detail::YamlNode content = detail::load_config(path, diagnostics);
  if (!content.is_list()) {
    diagnostics.error({path, 0}, "the file is " + detail::describe_config(content) +
                                     ", not a list of {joints: [], positions: [], features: []}");
    return poses;
  }
  std::size_t number = 0;
  for (const detail::YamlNode& element : content.items) {
    const SourceLocation place{path, element.line};
    const std::string subject = fmt::format("pose {}", ++number);
    if (!element.is_map()) {
      diagnostics.error(place, subject + " is " + detail::describe_config(element) + ", not a map");
      continue;
    }
    detail::ConfigMap map(element, place, subject, diagnostics);
    if (auto pose = detail::read_pose(map)) {
      poses.push_back(std::move(*pose));
      poses.back().source = place.str();
    }
  }
  if (poses.empty() && number > 0 && diagnostics.errors.empty()) {
    diagnostics.error({path, 0}, "no pose is left");
  }
  return poses;
}

void write_poses_yaml(std::ostream& out, const std::vector<CapturePose>& poses) {
  const auto names = [](const std::vector<std::string>& all) {
    std::string text;
    for (const std::string& name : all)
      text += (text.empty() ? "" : ", ") + detail::name_to_yaml(name);
    return text;
  };
  if (poses.empty()) out << "[]\n";
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const CapturePose& pose = poses[i];
    if (pose.joint_names.size() != pose.positions.size()) {
      throw std::invalid_argument(
          fmt::format("pose {}: {}", i + 1, detail::names_but_positions(pose)));
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
