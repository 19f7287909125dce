// Edits of one joint in the text of a URDF or xacro file: origin, limits, calibration, mimic.
//
// Numbers are rewritten one by one, where they differ.  Missing elements or attributes are created
// in the style of their neighbours, with the same quotes, indentation and line ends.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/joint.hpp"

namespace kinecal::detail {

/// Edits of one joint in the text.
struct UrdfJointEditor {
  const UrdfText& source;
  pugi::xml_node joint;
  std::vector<TextEdit>& edits;
  Diagnostics diagnostics = {};

  /// A tag without attributes uses the quotes of the joint's tag.
  [[nodiscard]] XmlTagEditor tag_of(pugi::xml_node element) const {
    StartTag tag = scan_start_tag(source.text(), source.offset(element));
    if (tag.attributes.empty()) {
      tag.quote = scan_start_tag(source.text(), source.offset(joint)).quote;
    }
    return {source.text(), tag, edits};
  }

  /// origin <- origin * moved_by; numbers that do not change keep their text.
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

  /// Adds to `rising`, and to `falling` if present.
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

  /// The numbers of <mimic>; those that do not change keep their text.
  void set_mimic(const Mimic& to) {
    const pugi::xml_node mimic = joint.child("mimic");
    const auto value = [&](const char* name, double missing) {
      return mimic.attribute(name) ? source.numbers(mimic, name, 1, diagnostics)[0] : missing;
    };
    const double multiplier = value("multiplier", 1.0), offset = value("offset", 0.0);
    source.throw_if_errors(diagnostics);
    XmlTagEditor editor = tag_of(mimic);
    if (to.multiplier != multiplier) editor.set("multiplier", {&to.multiplier, 1});
    if (to.offset != offset) editor.set("offset", {&to.offset, 1});
    editor.finish();
  }

  /// Moves limits and soft limits with the zero of the joint, so that they allow the same poses.
  /// @param by  to be added to them, radians or metres
  void shift_limits(double by) {
    if (by == 0.0) return;
    shift(joint.child("limit"), {"lower", "upper"}, by);
    shift(joint.child("safety_controller"), {"soft_lower_limit", "soft_upper_limit"}, by);
  }

  /// Adds to two attributes; does nothing if the element has neither.
  void shift(pugi::xml_node element, const std::array<const char*, 2>& names, double by) {
    if (!element.attribute(names[0]) && !element.attribute(names[1])) return;
    XmlTagEditor editor = tag_of(element);
    for (const char* name : names) {
      const double value = source.numbers(element, name, 1, diagnostics)[0] + by;
      editor.set(name, {&value, 1});
    }
    source.throw_if_errors(diagnostics);
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

  /// A new <calibration>, after the elements that place the joint and before its limits.
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

  /// For a new element in the style of another.
  [[nodiscard]] XmlTagEditor tag_like(pugi::xml_node other) const {
    XmlTagEditor editor = tag_of(other);
    editor.tag.attributes.clear();
    return editor;
  }
};

}  // namespace kinecal::detail
