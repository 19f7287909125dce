// Offsets of joints in <ros2_control>: <param name="offset"> of a joint, or of its position interfaces.
//
//   <ros2_control><joint name="elbow">
//     <param name="offset">0.02</param>
//
// The sign is that of the transmissions of ros2_control, which drivers follow that add their own
// parameter: position = reading + offset, radians or metres.
// Source: ros2_control, transmission_interface, simple_transmission.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// The joints of all <ros2_control> elements.
[[nodiscard]] inline std::vector<pugi::xml_node> ros2_control_joints(const UrdfText& source) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node control : source.robot().children("ros2_control")) {
    for (const pugi::xml_node joint : control.children("joint")) found.push_back(joint);
  }
  return found;
}

/// The offsets of a joint in <ros2_control>: its own, and those of its position interfaces.
[[nodiscard]] inline std::vector<pugi::xml_node> offset_params(pugi::xml_node joint) {
  std::vector<pugi::xml_node> found;
  const auto add = [&](pugi::xml_node element) {
    for (const pugi::xml_node param : element.children("param")) {
      if (std::string_view(param.attribute("name").value()) == "offset") found.push_back(param);
    }
  };
  add(joint);
  for (const pugi::xml_node child : joint.children()) {
    const std::string_view name = child.name();
    const bool is_interface = name == "command_interface" || name == "state_interface";
    if (is_interface && std::string_view(child.attribute("name").value()) == "position") add(child);
  }
  return found;
}

/// The text of a parameter between its tags.
struct ParamText {
  std::size_t begin, end;
  std::optional<double> value;  ///< nullopt if it is not a number
};

[[nodiscard]] inline ParamText param_text(const UrdfText& source, pugi::xml_node param) {
  const StartTag tag = scan_start_tag(source.text(), source.offset(param));
  if (tag.empty) return {tag.end, tag.end, std::nullopt};
  const std::size_t close = found_in_tag(source.text().find('<', tag.end));
  const std::string_view inside = std::string_view(source.text()).substr(tag.end, close - tag.end);
  const auto tokens = number_tokens(inside);
  if (!tokens || tokens->size() != 1) return {tag.end, close, std::nullopt};
  return {tag.end + tokens->front().begin, tag.end + tokens->front().end, tokens->front().value};
}

/// True if an offset may be radians or metres; drivers of servos have ticks, such as 2048.
[[nodiscard]] inline bool is_position(double offset, JointType type) {
  constexpr double kMostRadians = 2.0 * std::numbers::pi, kMostMetres = 10.0;
  return std::abs(offset) <= (turns(type) ? kMostRadians : kMostMetres);
}

/// True if <ros2_control> has an offset of the joint, in radians or metres.
[[nodiscard]] inline bool has_ros2_control_offset(const UrdfText& source, const Joint& of) {
  bool found = false;
  for (const pugi::xml_node joint : ros2_control_joints(source)) {
    if (joint.attribute("name").value() != of.name) continue;
    for (const pugi::xml_node param : offset_params(joint)) {
      const auto value = param_text(source, param).value;
      if (!value || !is_position(*value, of.type)) return false;
      found = true;
    }
  }
  return found;
}

/// A new offset, first in its joint.
inline void create_offset_param(const UrdfText& source, pugi::xml_node joint, double offset,
                                std::vector<TextEdit>& edits) {
  const StartTag tag = scan_start_tag(source.text(), source.offset(joint));
  const std::string param = std::string("<param name=") + tag.quote + "offset" + tag.quote + ">" +
                            xml_number(offset) + "</param>";
  if (tag.empty) {
    const std::string name = joint.name();
    edits.push_back(
        {tag.attributes_end, tag.end - tag.attributes_end, ">" + param + "</" + name + ">"});
    return;
  }
  const std::size_t next = source.text().find_first_not_of(kXmlSpace, tag.end);
  const bool is_last = source.text().compare(next, 2, "</") == 0;
  const std::string line = line_start_before(source.text(), next);
  edits.push_back({tag.end, 0, line + (is_last && !line.empty() ? "  " : "") + param});
}

/// Adds to the offset of a joint in <ros2_control>, which is created if it is missing.
/// @param offset  radians or metres
/// @throws InputError  if <ros2_control> does not have the joint, or its offset is not radians or metres
inline void add_ros2_control_offset(const UrdfText& source, const Joint& of, double offset,
                                    std::vector<TextEdit>& edits) {
  std::vector<std::string> names;
  bool found = false;
  for (const pugi::xml_node joint : ros2_control_joints(source)) {
    names.emplace_back(joint.attribute("name").value());
    if (names.back() != of.name) continue;
    found = true;
    const std::vector<pugi::xml_node> params = offset_params(joint);
    if (params.empty()) create_offset_param(source, joint, offset, edits);
    for (const pugi::xml_node param : params) {
      const auto [begin, end, value] = param_text(source, param);
      if (!value || !is_position(*value, of.type)) {
        throw InputError(source.place(param).str() + ": joint '" + of.name + "': offset '" +
                         param.child_value() + "' of <ros2_control> is not in " +
                         (turns(of.type) ? "radians" : "metres") + "; use --offsets origin");
      }
      edits.push_back({begin, end - begin, xml_number(*value + offset)});
    }
  }
  if (found) return;
  throw InputError(source.file() + ": <ros2_control> has no joint '" + of.name + "'" +
                   did_you_mean(of.name, names) + "; use --offsets origin or rising");
}

}  // namespace kinecal::detail
