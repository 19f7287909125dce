// The joints of a xacro file, found by the names that they have in its URDF.
//
// A name may hold expressions: "${prefix}elbow_joint" may be "left_elbow_joint" and "right_elbow_joint".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal::detail {

/// True if a text holds an expression of xacro.
[[nodiscard]] inline bool is_expression(std::string_view text) {
  return text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos;
}

/// The literal parts of a name, between its expressions.
[[nodiscard]] inline std::vector<std::string_view> literal_parts(std::string_view name) {
  std::vector<std::string_view> parts;
  while (true) {
    const std::size_t begin = std::min(name.find("${"), name.find("$("));
    parts.push_back(name.substr(0, begin));
    if (begin == std::string_view::npos) return parts;
    const std::size_t end = name.find(name[begin + 1] == '{' ? '}' : ')', begin);
    name = end == std::string_view::npos ? std::string_view() : name.substr(end + 1);
  }
}

/// Length of the literal parts of a name if it may expand to another; -1 if not.
[[nodiscard]] inline int matched_length(std::string_view name, std::string_view expanded) {
  const std::vector<std::string_view> parts = literal_parts(name);
  if (parts.size() == 1) return name == expanded ? static_cast<int>(name.size()) : -1;
  if (!expanded.starts_with(parts.front())) return -1;
  std::size_t at = parts.front().size(), length = at + parts.back().size();
  for (std::size_t i = 1; i + 1 < parts.size(); ++i) {
    at = expanded.find(parts[i], at);
    if (at == std::string_view::npos) return -1;
    at += parts[i].size();
    length += parts[i].size();
  }
  const bool ends = at + parts.back().size() <= expanded.size() && expanded.ends_with(parts.back());
  return ends && length > 0 ? static_cast<int>(length) : -1;
}

/// All joints of a xacro file that become joints of the robot, in macros and conditions as well.
[[nodiscard]] inline std::vector<pugi::xml_node> xacro_joints(pugi::xml_node element) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node child : element.children()) {
    const std::string_view name = child.name();
    if (name == "joint") {
      found.push_back(child);
    } else if (name != "ros2_control" && name != "transmission" && name != "gazebo" &&
               name != "link") {
      for (const pugi::xml_node inside : xacro_joints(child)) found.push_back(inside);
    }
  }
  return found;
}

/// The joints whose names fit best: one, unless the file is ambiguous or does not have it.
[[nodiscard]] inline std::vector<pugi::xml_node> joints_named(
    const std::vector<pugi::xml_node>& joints, const std::string& expanded) {
  std::vector<pugi::xml_node> best;
  int longest = 0;
  for (const pugi::xml_node joint : joints) {
    const int length = matched_length(joint.attribute("name").value(), expanded);
    if (length < longest || length <= 0) continue;
    if (length > longest) best.clear();
    longest = length;
    best.push_back(joint);
  }
  return best;
}

}  // namespace kinecal::detail
