// The text of a URDF: its joints and numbers, with their lines.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/xacro_remnants.ipp"
#include "kinecal/files/xml/xml_numbers.ipp"
#include "kinecal/files/xml/xml_text.ipp"
#include "kinecal/geometry/rotation.hpp"

namespace kinecal::detail {

class UrdfText : public XmlText {
 public:
  /// @param file  name of the file for messages
  /// @throws InputError  if the text is empty, not XML, not UTF-8, its root is not <robot>, or it has
  ///                     too many joints
  UrdfText(std::string text, std::string file)
      : XmlText(std::move(text), std::move(file), {"a URDF", "robot"}) {
    constexpr std::size_t kMostJoints = 5000;  // robots have hundreds
    std::size_t count = 0;
    for (const pugi::xml_node node : robot().children("joint")) {
      joints_.emplace(node.attribute("name").value(), node);
      if (++count <= kMostJoints) continue;
      throw InputError(place(node).str() + ": the robot has more than " +
                       std::to_string(kMostJoints) + " joints, which is the most that is read");
    }
  }

  [[nodiscard]] pugi::xml_node robot() const { return root(); }

  /// The joint of that name among the children of <robot>, not in <transmission> or <gazebo>; a
  /// null node if there is no such joint.
  [[nodiscard]] pugi::xml_node joint(const std::string& name) const {
    const auto found = joints_.find(name);
    return found == joints_.end() ? pugi::xml_node() : found->second;
  }

  /// Location of the first joint, or else of the first link, that a message names in '' or [].
  [[nodiscard]] SourceLocation place_of_name_in(std::string_view message) const {
    for (const char* kind : {"joint", "link"}) {
      for (std::size_t open = message.find_first_of("'["); open != std::string_view::npos;
           open = message.find_first_of("'[", open + 1)) {
        const std::size_t close = message.find(message[open] == '[' ? ']' : '\'', open + 1);
        if (close == std::string_view::npos) continue;
        const std::string name(message.substr(open + 1, close - open - 1));
        const pugi::xml_node found = robot().find_child_by_attribute(kind, "name", name.c_str());
        if (found) return place(found);
      }
    }
    return {file(), 0};
  }

  /// The numbers of an attribute.
  /// @param count  required number; any other is an error
  /// @return       (count) zeros if there is no such attribute, or an error
  [[nodiscard]] std::vector<double> numbers(pugi::xml_node element, const char* attribute,
                                            std::size_t count, Diagnostics& diagnostics) const {
    std::vector<double> values(count, 0.0);
    const pugi::xml_attribute found = element.attribute(attribute);
    if (!found) return values;
    const auto tokens = number_tokens(found.value());
    if (tokens && tokens->size() == count) {
      std::transform(tokens->begin(), tokens->end(), values.begin(),
                     [](const NumberToken& token) { return token.value; });
    } else {
      diagnostics.error(place(element),
                        std::string("joint '") + element.parent().attribute("name").value() +
                            "': " + attribute + "=\"" + found.value() + "\" of <" + element.name() +
                            "> is not " +
                            (count == 1 ? "a number" : std::to_string(count) + " numbers"));
    }
    return values;
  }

  [[nodiscard]] Vector3<double> vector(pugi::xml_node element, const char* attribute,
                                       Diagnostics& diagnostics) const {
    const std::vector<double> values = numbers(element, attribute, 3, diagnostics);
    return {values[0], values[1], values[2]};
  }

  /// Throws the collected errors.  If xacro has not been run, only the first error and the likely
  /// cause.
  /// @throws InputError  if there are errors
  void throw_if_errors(const Diagnostics& diagnostics) const {
    if (!diagnostics.errors.empty() && is_unexpanded(robot())) {
      throw InputError(diagnostics.errors.front() +
                       "; the file is xacro, not URDF: run xacro on it first");
    }
    diagnostics.throw_if_errors();
  }

 private:
  std::map<std::string, pugi::xml_node> joints_;  ///< by name; the first of each
};

}  // namespace kinecal::detail
