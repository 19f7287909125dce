// Remnants of xacro in a URDF: elements <xacro:...>, and attributes with ${...} or $(...).
//
// ROS ignores unknown elements, so a robot may work although some are left.  A remnant is inert if
// no link, joint or number of a joint can depend on it:
//
//   inert    definitions (property, arg, macro); what stands in a <link>, <material>, <gazebo> or any
//            other element of the robot; a call of a macro that this file defines without links and joints
//   not      other calls, includes and conditions beside links and joints, which could hold some;
//            elements in a <joint> without origin or axis; ${...} in a <joint> or in a link's name
//
// Source: ROS wiki, xacro; URDF specification.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal::detail {

/// An element that xacro should have replaced, or one with such an attribute.
struct XacroRemnant {
  pugi::xml_node element;
  std::string text;      ///< "<xacro:hand>", or "xyz="${x} 0 0" of <origin>"
  bool is_inert = true;  ///< false: links, joints or numbers may be missing
};

/// Finds the remnants of a URDF.
class XacroRemnants {
 public:
  explicit XacroRemnants(pugi::xml_node robot) : robot_(robot) {
    for (const pugi::xml_node child : robot.children()) {
      if (xacro_name(child) == "macro") macros_.emplace(child.attribute("name").value(), child);
    }
    add_expressions(robot, false);
    for (const pugi::xml_node child : robot.children()) visit(child, Place::robot);
  }

  [[nodiscard]] const std::vector<XacroRemnant>& all() const { return all_; }

 private:
  /// Where an element is.
  enum class Place { robot, joint, elsewhere };

  /// The name without the prefix of xacro; empty for elements that are not of xacro.
  [[nodiscard]] static std::string_view xacro_name(pugi::xml_node element) {
    const std::string_view name = element.name();
    const std::size_t colon = name.find(':');
    if (colon == std::string_view::npos) return {};
    const std::string_view prefix = name.substr(0, colon);
    bool is_xacro = prefix == "xacro";
    const std::string space = "xmlns:" + std::string(prefix);
    for (pugi::xml_node at = element; at && !is_xacro; at = at.parent()) {
      is_xacro = std::string_view(at.attribute(space.c_str()).value()).ends_with("/xacro");
    }
    return is_xacro ? name.substr(colon + 1) : std::string_view();
  }

  [[nodiscard]] static bool is_definition(std::string_view name) {
    return name == "property" || name == "arg" || name == "macro";
  }

  /// True if an element of xacro could expand to links or joints at its place.
  /// @param in_macro  true inside a macro: does not follow calls of others, which may form a circle
  [[nodiscard]] bool could_hold_links(pugi::xml_node element, bool in_macro = false) const {
    const std::string_view name = xacro_name(element);
    if (is_definition(name)) return false;
    if (name == "if" || name == "unless") return holds_links(element, in_macro);
    const auto macro = in_macro ? macros_.end() : macros_.find(name);
    return macro == macros_.end() || holds_links(macro->second, true);
  }

  [[nodiscard]] bool holds_links(pugi::xml_node element, bool in_macro) const {
    const auto children = element.children();
    return std::any_of(children.begin(), children.end(), [&](pugi::xml_node child) {
      const std::string_view name = child.name();
      if (name == "link" || name == "joint") return true;
      return !xacro_name(child).empty() && could_hold_links(child, in_macro);
    });
  }

  /// True if a joint lacks something that an element of xacro in it could supply.
  [[nodiscard]] static bool lacks_a_part(pugi::xml_node joint) {
    return !joint.child("origin") || !joint.child("parent") || !joint.child("child") ||
           (std::string_view(joint.attribute("type").value()) != "fixed" && !joint.child("axis"));
  }

  /// @param matters  true if the element belongs to a joint
  void add_expressions(pugi::xml_node element, bool matters) {
    const bool is_link = std::string_view(element.name()) == "link" && element.parent() == robot_;
    for (const pugi::xml_attribute attribute : element.attributes()) {
      const std::string_view value = attribute.value();
      if (value.find("${") == std::string_view::npos &&
          value.find("$(") == std::string_view::npos) {
        continue;
      }
      const bool names_link = is_link && std::string_view(attribute.name()) == "name";
      all_.push_back({element,
                      std::string(attribute.name()) + "=\"" + attribute.value() + "\" of <" +
                          element.name() + ">",
                      !matters && !names_link});
    }
  }

  void visit(pugi::xml_node element, Place place) {
    const std::string_view name = element.name();
    if (const std::string_view of_xacro = xacro_name(element); !of_xacro.empty()) {
      bool matters = place == Place::robot && could_hold_links(element);
      if (place == Place::joint && !is_definition(of_xacro)) matters = lacks_a_part(joint_);
      all_.push_back({element, "<" + std::string(name) + ">", !matters});
      return;
    }
    if (place == Place::robot && name == "joint") joint_ = element, place = Place::joint;
    add_expressions(element, place == Place::joint);
    const Place inside = place == Place::joint ? place : Place::elsewhere;
    for (const pugi::xml_node child : element.children()) visit(child, inside);
  }

  pugi::xml_node robot_, joint_;
  std::map<std::string_view, pugi::xml_node> macros_;  ///< that the robot defines, by name
  std::vector<XacroRemnant> all_;
};

/// True if links, joints or numbers of joints may be missing, because xacro has not been run.
[[nodiscard]] inline bool is_unexpanded(pugi::xml_node robot) {
  const XacroRemnants remnants(robot);
  return std::any_of(remnants.all().begin(), remnants.all().end(),
                     [](const XacroRemnant& remnant) { return !remnant.is_inert; });
}

}  // namespace kinecal::detail
