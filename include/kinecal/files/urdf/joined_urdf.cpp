// Definitions of joined_urdf.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/joined_urdf.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <optional>
#include <pugixml.hpp>
#include <utility>

#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/urdf/urdf_text.ipp"

namespace kinecal {

namespace detail {
namespace {

/// An element and its attribute with a name.
struct NamingAttribute {
  std::string_view element, attribute;
};
constexpr std::array<NamingAttribute, 12> kNaming = {{{"link", "name"},
                                                      {"joint", "name"},
                                                      {"parent", "link"},
                                                      {"child", "link"},
                                                      {"mimic", "joint"},
                                                      {"material", "name"},
                                                      {"transmission", "name"},
                                                      {"actuator", "name"},
                                                      {"sensor", "name"},
                                                      {"gpio", "name"},
                                                      {"ros2_control", "name"},
                                                      {"gazebo", "reference"}}};

/// Calls a function with the place of each name in the text of a URDF.
/// @param visit  (begin, end)
template <class Visit>
void for_each_name(const UrdfText& source, pugi::xml_node parent, const Visit& visit) {
  for (const pugi::xml_node element : parent.children()) {
    if (element.type() != pugi::node_element) continue;
    const std::string_view kind = element.name();
    const StartTag tag = scan_start_tag(source.text(), source.offset(element));
    for (const NamingAttribute& naming : kNaming) {
      const AttributeText* name = naming.element == kind ? tag.find(naming.attribute) : nullptr;
      if (name != nullptr && name->begin < name->end) visit(name->begin, name->end);
    }
    const bool mimics = kind == "param" && !tag.empty &&
                        std::string_view(element.attribute("name").value()) == "mimic";
    if (mimics) {  // of <ros2_control>: its text is a joint
      const std::size_t begin = source.text().find_first_not_of(kXmlSpace, tag.end);
      const std::size_t end = source.text().find_first_of(" \t\r\n<", begin);
      if (begin < end && end != std::string::npos) visit(begin, end);
    }
    if (kind != "gazebo") for_each_name(source, element, visit);
  }
}

/// Names of files of meshes and textures that are relative.
template <class Visit>
void for_each_relative_file(const UrdfText& source, pugi::xml_node parent, const Visit& visit) {
  for (const pugi::xml_node element : parent.children()) {
    if (element.type() != pugi::node_element) continue;
    const std::string_view kind = element.name();
    const std::string_view file = element.attribute("filename").value();
    const bool is_relative =
        !file.empty() && file.front() != '/' && file.find("://") == std::string_view::npos;
    if ((kind == "mesh" || kind == "texture") && is_relative) {
      const StartTag tag = scan_start_tag(source.text(), source.offset(element));
      visit(tag.find("filename")->begin);
    }
    for_each_relative_file(source, element, visit);
  }
}

/// What is between the tags of <robot>.
[[nodiscard]] std::string inside_of_robot(const std::string& text, std::size_t robot) {
  const StartTag tag = scan_start_tag(text, robot);
  if (tag.empty) return "";
  const std::size_t end = text.rfind("</", element_end(text, robot) - 1);
  return text.substr(tag.end, end - tag.end);
}

/// @throws InputError  as joined_urdf()
void check_robot_names(std::span<const RobotPart> parts) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::string& name = parts[i].name;
    const bool is_plain = std::all_of(name.begin(), name.end(), [](unsigned char c) {
      return std::isalnum(c) != 0 || c == '_' || c == '-';
    });
    if (name.empty() || !is_plain || std::isalpha(static_cast<unsigned char>(name.front())) == 0 ||
        name == kWorldLink) {
      throw InputError(fmt::format(
          "'{}' cannot be the name of a robot: give letters, digits, _ and -, a letter first{}",
          name, name == kWorldLink ? "; on 'world' all of them stand" : ""));
    }
    for (std::size_t j = 0; j < parts.size(); ++j) {
      const std::string& other = parts[j].name;
      if (i == j || !(other + "_").starts_with(name + "_")) continue;
      throw InputError(
          name == other
              ? fmt::format("two robots are called '{}'; each has a name of its own", name)
              : fmt::format("the names of robot '{}' would begin like those of '{}'; "
                            "choose another name",
                            other, name));
    }
  }
}

/// A robot with its names and its stand.
[[nodiscard]] std::string standing_robot(const RobotPart& part) {
  const Robot robot = parse_urdf(part.text, part.file);  // reports what is wrong with it
  const UrdfText source(part.text, part.file);
  std::string root = source.robot().child("link").attribute("name").value();
  while (const Joint* above = robot.parent_joint(root)) root = above->parent;
  std::vector<TextEdit> edits;
  for_each_name(source, source.robot(), [&](std::size_t begin, std::size_t) {
    edits.push_back({begin, 0, part.name + "_"});
  });
  if (!part.folder.empty()) {
    for_each_relative_file(source, source.robot(), [&](std::size_t begin) {
      edits.push_back({begin, 0, xml_attribute_text(part.folder + "/", '"')});
    });
  }
  const auto numbers = [](const Vector3<double>& of) {
    return fmt::format("{} {} {}", xml_number(of.x()), xml_number(of.y()), xml_number(of.z()));
  };
  std::string text = fmt::format(
      "  <joint name=\"{}\" type=\"fixed\">\n    <parent link=\"{}\"/>\n    <child link=\"{}\"/>\n"
      "    <origin xyz=\"{}\" rpy=\"{}\"/>\n  </joint>\n",
      stand_joint(part.name), kWorldLink, xml_attribute_text(part.name + "_" + root, '"'),
      numbers(part.xyz), numbers(part.rpy));
  if (robot.name().find("--") == std::string::npos) {
    text += fmt::format("  <!-- Robot {}. -->", robot.name());
  }
  const std::string inside =
      inside_of_robot(apply_edits(part.text, std::move(edits)), source.offset(source.robot()));
  return text + inside + (inside.ends_with('\n') ? "" : "\n");
}

/// A robot in a joined URDF: the text after its stand.
struct JoinedRobot {
  std::string name;
  std::size_t begin, end;
};

/// The robots of a joined URDF; empty for any other.
[[nodiscard]] std::vector<JoinedRobot> robots_in(const UrdfText& source) {
  std::vector<JoinedRobot> robots;
  bool has_world = false;
  for (const pugi::xml_node element : source.robot().children()) {
    if (element.type() != pugi::node_element) continue;
    const std::string_view kind = element.name(), name = element.attribute("name").value();
    if (kind == "link" && name == kWorldLink && robots.empty()) {
      has_world = true;
      continue;
    }
    const bool is_stand =
        kind == "joint" && kWorldLink == element.child("parent").attribute("link").value();
    const std::size_t at = source.offset(element);
    if (is_stand) {
      if (!name.starts_with(stand_joint(""))) return {};
      if (!robots.empty()) robots.back().end = at;
      robots.push_back({std::string(name.substr(stand_joint("").size())),
                        element_end(source.text(), at), std::string::npos});
      continue;
    }
    const bool is_named = kind == "link" || kind == "joint";
    if (is_named && (robots.empty() || !name.starts_with(robots.back().name + "_"))) return {};
  }
  if (!has_world || robots.size() < 2) return {};
  const std::size_t robot = source.offset(source.robot());
  robots.back().end = source.text().rfind("</", element_end(source.text(), robot) - 1);
  return robots;
}

/// The name that a URDF gave itself, at the begin of its text in a joined one, which it is taken out of.
[[nodiscard]] std::optional<std::string> taken_name(std::string& text) {
  constexpr std::string_view kBegin = "<!-- Robot ", kEnd = ". -->";
  const std::size_t begin = text.find_first_not_of(kXmlSpace), end = text.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos ||
      text.compare(begin, kBegin.size(), kBegin) != 0) {
    return std::nullopt;
  }
  std::string name = text.substr(begin + kBegin.size(), end - begin - kBegin.size());
  text.erase(0, end + kEnd.size());
  return name;
}

}  // namespace
}  // namespace detail

std::string stand_joint(const std::string& robot) {
  return std::string(kWorldLink) + "_" + robot;
}

std::string joined_urdf(std::span<const RobotPart> parts) {
  detail::check_robot_names(parts);
  std::string names, robots;
  for (const RobotPart& part : parts) {
    names += (names.empty() ? "" : "_") + part.name;
    robots += detail::standing_robot(part);
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"{}\"/>\n{}</robot>\n", names,
      kWorldLink, robots);
}

std::vector<std::string> joined_robots(const std::string& text, const std::string& file) {
  std::vector<std::string> names;
  for (const detail::JoinedRobot& robot : detail::robots_in(detail::UrdfText(text, file)))
    names.push_back(robot.name);
  return names;
}

std::string separated_urdf(const std::string& text, const std::string& file,
                           const std::string& name) {
  const detail::UrdfText source(text, file);
  const std::vector<detail::JoinedRobot> robots = detail::robots_in(source);
  const auto robot =
      std::find_if(robots.begin(), robots.end(), [&](const auto& one) { return one.name == name; });
  if (robot == robots.end()) throw InputError(file + ": has no robot '" + name + "' of several");
  const std::string prefix = name + "_";
  std::vector<detail::TextEdit> edits;
  detail::for_each_name(source, source.robot(), [&](std::size_t begin, std::size_t end) {
    const bool is_in = begin >= robot->begin && end <= robot->end;
    if (is_in && text.compare(begin, prefix.size(), prefix) == 0) {
      edits.push_back({begin - robot->begin, prefix.size(), ""});
    }
  });
  std::string inside =
      detail::apply_edits(text.substr(robot->begin, robot->end - robot->begin), std::move(edits));
  const std::string own = detail::taken_name(inside).value_or(name);
  const std::size_t last = inside.find_last_not_of(detail::kXmlSpace);
  inside.erase(last == std::string::npos ? 0 : last + 1);
  return fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"{}\">{}\n</robot>\n",
                     detail::xml_attribute_text(own, '"'), inside);
}

}  // namespace kinecal
