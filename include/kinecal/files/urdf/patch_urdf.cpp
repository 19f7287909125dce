// The edits of a URDF's text: definitions of patch_urdf.hpp.
//
// Numbers are rewritten one by one, where they differ.  Missing elements or attributes are created
// in the style of their neighbours, with the same quotes, indentation and line ends.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/patch_urdf.hpp"

#include <cmath>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Edits of one joint in the text: its origin and its calibration.
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

/// The change of one joint in the text.
struct UrdfJointChange {
  Pose<double> moved_by = {};  ///< origin <- origin * moved_by
  double rising = 0.0;         ///< to be added to <calibration rising>
};

using UrdfJointChanges = std::map<std::string, UrdfJointChange>;

/// @throws InputError  if the joint is not in the file, or cannot have this patch
void check_patch(const UrdfText& source, const Robot& robot, const JointPatch& patch) {
  const std::string& name = patch.joint;
  const pugi::xml_node node = source.joint(name);
  const auto fail = [&](const std::string& message) {
    throw InputError(source.place(node).str() + ": " + message);
  };
  if (!node) fail("no joint '" + name + "'" + did_you_mean(name, robot.joint_names()));
  if (!robot.has_joint(name)) {
    fail("joint '" + name + "' is not a joint of robot '" + robot.name() + "'");
  }
  const bool finite = std::isfinite(patch.offset) && patch.correction.translation.allFinite() &&
                      patch.correction.rotation.allFinite();
  if (!finite) fail("the calibration of joint '" + name + "' is not finite");
  if (patch.offset == 0.0) return;
  const Joint& joint = robot.joint(name);
  if (!moves(joint.type)) {
    fail("joint '" + name + "' is " + std::string(to_string(joint.type)) +
         ": it has no position to add an offset to");
  }
  if (joint.mimic) {
    fail("joint '" + name + "' mimics another: the offset belongs to joint '" +
         drive(robot, joint).joint + "'");
  }
}

/// The changes of all joints by all patches together.
[[nodiscard]] UrdfJointChanges urdf_joint_changes(const UrdfText& source, const Robot& robot,
                                                  const std::vector<JointPatch>& patches,
                                                  OffsetStyle style) {
  UrdfJointChanges changes;
  for (const JointPatch& patch : patches) {
    check_patch(source, robot, patch);
    const double rising = style == OffsetStyle::rising ? patch.offset : 0.0;
    if (!changes.try_emplace(patch.joint, UrdfJointChange{patch.correction, rising}).second) {
      throw InputError(source.place(source.joint(patch.joint)).str() + ": joint '" + patch.joint +
                       "' is given two calibrations");
    }
  }
  if (style == OffsetStyle::rising) return changes;
  for (const JointPatch& patch : patches) {
    if (patch.offset == 0.0) continue;
    for (const Joint& joint : robot.joints()) {  // itself and those that mimic it
      const Mimic driven = drive(robot, joint);
      if (driven.joint != patch.joint) continue;
      Pose<double>& moved_by = changes[joint.name].moved_by;
      moved_by = moved_by * joint_pose(joint.type, joint.axis,
                                       make_joint_state(driven.multiplier * patch.offset));
    }
  }
  return changes;
}

}  // namespace
}  // namespace detail

std::string patch_urdf(const std::string& text, const std::string& name_for_messages,
                       const Robot& robot, const std::vector<JointPatch>& patches,
                       OffsetStyle style) {
  const detail::UrdfText source(text, name_for_messages);
  std::vector<detail::TextEdit> edits;
  for (const auto& [name, change] : detail::urdf_joint_changes(source, robot, patches, style)) {
    const pugi::xml_node joint = source.joint(name);
    if (!joint) throw InputError(name_for_messages + ": no joint '" + name + "'");
    detail::UrdfJointEditor editor{source, joint, edits};
    editor.move_origin(change.moved_by);
    editor.add_rising(change.rising);
  }
  return detail::apply_edits(text, std::move(edits));
}

}  // namespace kinecal
