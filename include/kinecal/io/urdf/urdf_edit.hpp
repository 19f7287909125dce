// The edits of one joint in the text of a URDF: its origin and its calibration.
//
// Numbers are rewritten one by one, where they differ.  What is missing is created in the manner of
// its neighbours: their quotes, indentation and line ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/io/urdf/urdf_text.hpp"
#include "kinecal/io/urdf/xml_edit.hpp"

namespace kinecal::detail {

/// Shortest text that reads back as the same number; zero has no sign.
[[nodiscard]] inline std::string urdf_number(double value) {
  return fmt::format("{}", value + 0.0);
}

/// Edits of numbers in one start tag.
struct XmlTagEditor {
  const std::string& text;
  StartTag tag;
  std::vector<TextEdit>& edits;
  std::string added = {};  ///< attributes to be created

  /// Rewrites those numbers of an attribute that differ; creates the attribute where missing.
  void set(std::string_view name, std::span<const double> values) {
    std::string all;
    for (double value : values) all += (all.empty() ? "" : " ") + urdf_number(value);
    const AttributeText* attribute = tag.find(name);
    if (attribute == nullptr) {
      added += fmt::format(" {}={}{}{}", name, tag.quote, all, tag.quote);
      return;
    }
    const std::size_t length = attribute->end - attribute->begin;
    const auto tokens = number_tokens(std::string_view(text).substr(attribute->begin, length));
    if (!tokens || tokens->size() != values.size()) {  // written with character references
      edits.push_back({attribute->begin, length, all});
      return;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      const auto& [begin, end, value] = (*tokens)[i];
      if (value == values[i]) continue;
      edits.push_back({attribute->begin + begin, end - begin, urdf_number(values[i])});
    }
  }

  /// The attributes created, as an element of their own.
  [[nodiscard]] std::string element(const std::string& name) const {
    return "<" + name + added + std::string(tag.closing());
  }

  void finish() {
    if (!added.empty()) edits.push_back({tag.attributes_end, 0, added});
  }
};

/// A joint's text as it is changed.
struct UrdfJointEditor {
  const UrdfText& source;
  pugi::xml_node joint;
  std::vector<TextEdit>& edits;
  Diagnostics diagnostics = {};

  /// Without attributes of its own, the tag's quotes are those of the joint's tag.
  [[nodiscard]] XmlTagEditor tag_of(pugi::xml_node element) const {
    StartTag tag = scan_start_tag(source.text(), source.offset(element));
    if (tag.attributes.empty()) {
      tag.quote = scan_start_tag(source.text(), source.offset(joint)).quote;
    }
    return {source.text(), tag, edits};
  }

  /// origin <- origin * moved_by; what moved_by does not change is not touched.
  void move_origin(const Pose<double>& moved_by) {
    const bool is_shifted = moved_by.translation != Vector3<double>::Zero();
    const bool is_turned = moved_by.rotation != Matrix3<double>::Identity();
    if (!is_shifted && !is_turned) return;
    const pugi::xml_node origin = joint.child("origin");
    Vector3<double> xyz = source.vector(origin, "xyz", diagnostics);
    Vector3<double> rpy = source.vector(origin, "rpy", diagnostics);
    source.throw_if_errors(diagnostics);
    const Matrix3<double> rotation = rotation_from_rpy(rpy);
    if (is_shifted) xyz += rotated(rotation, moved_by.translation);
    if (is_turned) rpy = rpy_from_rotation(rotation * moved_by.rotation);
    if (!origin) return create_origin(xyz, rpy);
    XmlTagEditor editor = tag_of(origin);
    if (is_shifted) editor.set("xyz", {xyz.data(), 3});
    if (is_turned) editor.set("rpy", {rpy.data(), 3});
    editor.finish();
  }

  /// Adds to `rising`, and to `falling` where it stands.
  void add_rising(double offset) {
    if (offset == 0.0) return;
    const pugi::xml_node calibration = joint.child("calibration");
    double rising = source.numbers(calibration, "rising", 1, diagnostics)[0];
    double falling = source.numbers(calibration, "falling", 1, diagnostics)[0];
    source.throw_if_errors(diagnostics);
    rising += offset;
    falling += offset;
    if (!calibration) return create_calibration(rising);
    XmlTagEditor editor = tag_of(calibration);
    editor.set("rising", {&rising, 1});
    if (calibration.attribute("falling")) editor.set("falling", {&falling, 1});
    editor.finish();
  }

  /// A new <origin>, first in its joint.
  void create_origin(const Vector3<double>& xyz, const Vector3<double>& rpy) {
    const std::size_t at = tag_of(joint).tag.end;
    const std::size_t next = source.text().find_first_not_of(kXmlSpace, at);
    XmlTagEditor origin = tag_like(first_placing());
    origin.set("xyz", {xyz.data(), 3});
    origin.set("rpy", {rpy.data(), 3});
    edits.push_back({at, 0, line_start_before(source.text(), next) + origin.element("origin")});
  }

  /// A new <calibration>, behind what places the joint and in front of its limits.
  void create_calibration(double rising) {
    pugi::xml_node last = first_placing();
    for (pugi::xml_node child : joint.children()) {
      if (places_joint(child)) last = child;
    }
    const std::size_t begin = source.offset(last);
    XmlTagEditor calibration = tag_like(last);
    calibration.set("rising", {&rising, 1});
    edits.push_back({element_end(source.text(), begin), 0,
                     line_start_before(source.text(), begin) + calibration.element("calibration")});
  }

  [[nodiscard]] static bool places_joint(pugi::xml_node child) {
    const std::string_view name = child.name();
    return name == "origin" || name == "parent" || name == "child" || name == "axis";
  }

  [[nodiscard]] pugi::xml_node first_placing() const {
    if (const pugi::xml_node found = joint.find_child(places_joint)) return found;
    throw InputError(source.place(joint).str() + ": joint '" + joint.attribute("name").value() +
                     "' has no <parent>");
  }

  /// For a new element, written in the manner of another.
  [[nodiscard]] XmlTagEditor tag_like(pugi::xml_node other) const {
    XmlTagEditor editor = tag_of(other);
    editor.tag.attributes.clear();
    return editor;
  }
};

}  // namespace kinecal::detail
