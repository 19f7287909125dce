// The changes of a URDF's joints: definitions of patch_urdf.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/patch_urdf.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <pugixml.hpp>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/joint_editor.ipp"
#include "kinecal/files/urdf/urdf_text.ipp"
#include "kinecal/kinematics/joint.hpp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

// Offsets of joints in <ros2_control>: <param name="offset"> of a joint, or of its position interfaces.
//
//   <ros2_control><joint name="elbow">
//     <param name="offset">0.02</param>
//
// The sign is that of the transmissions of ros2_control, which drivers follow that add their own
// parameter: position = reading + offset, radians or metres.
// Source: ros2_control, transmission_interface, simple_transmission.hpp.

/// The joints of all <ros2_control> elements.
[[nodiscard]] std::vector<pugi::xml_node> ros2_control_joints(const UrdfText& source) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node control : source.robot().children("ros2_control")) {
    for (const pugi::xml_node joint : control.children("joint")) found.push_back(joint);
  }
  return found;
}

/// The offsets of a joint in <ros2_control>: its own, and those of its position interfaces.
[[nodiscard]] std::vector<pugi::xml_node> offset_params(pugi::xml_node joint) {
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

[[nodiscard]] ParamText param_text(const UrdfText& source, pugi::xml_node param) {
  const StartTag tag = scan_start_tag(source.text(), source.offset(param));
  if (tag.empty) return {tag.end, tag.end, std::nullopt};
  const std::size_t close = found_in_tag(source.text().find('<', tag.end));
  const std::string_view inside = std::string_view(source.text()).substr(tag.end, close - tag.end);
  const auto tokens = number_tokens(inside);
  if (!tokens || tokens->size() != 1) return {tag.end, close, std::nullopt};
  return {tag.end + tokens->front().begin, tag.end + tokens->front().end, tokens->front().value};
}

/// True if an offset may be radians or metres; drivers of servos have ticks, such as 2048.
[[nodiscard]] bool is_position(double offset, JointType type) {
  constexpr double kMostRadians = 2.0 * std::numbers::pi, kMostMetres = 10.0;
  return std::abs(offset) <= (turns(type) ? kMostRadians : kMostMetres);
}

/// True if <ros2_control> has an offset of the joint, in radians or metres.
[[nodiscard]] bool has_ros2_control_offset(const UrdfText& source, const Joint& of) {
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
void create_offset_param(const UrdfText& source, pugi::xml_node joint, double offset,
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
void add_ros2_control_offset(const UrdfText& source, const Joint& of, double offset,
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

// What a calibration changes at the joints of a URDF: origins, limits, and where offsets are held.

/// The change of one joint in the text.
struct UrdfJointChange {
  Pose<double> moved_by = {};  ///< origin <- origin * moved_by
  double rising = 0.0;         ///< to be added to <calibration rising>
  double ros2_control = 0.0;   ///< to be added to the offset of <ros2_control>
  double limits = 0.0;         ///< to be added to the limits
};

using UrdfJointChanges = std::map<std::string, UrdfJointChange>;

/// Turns or slides the origin of a joint, and of those that mimic it, by its offset.
void move_zero_into_origins(const Robot& robot, const JointPatch& patch,
                            UrdfJointChanges& changes) {
  for (const Joint& joint : robot.joints()) {
    const Mimic driven = drive(robot, joint);
    if (driven.joint != patch.joint) continue;
    const double by = driven.multiplier * patch.offset;
    UrdfJointChange& change = changes[joint.name];
    change.moved_by = change.moved_by * joint_pose(joint.type, joint.axis, make_joint_state(by));
    if (joint.limits) change.limits = -by;
  }
}

/// The changes of all joints by all patches together.
/// @param style_of  where the offset of a joint goes
template <class StyleOf>
[[nodiscard]] UrdfJointChanges urdf_joint_changes(const Robot& robot,
                                                  const std::vector<JointPatch>& patches,
                                                  const StyleOf& style_of) {
  UrdfJointChanges changes;
  for (const JointPatch& patch : patches) changes[patch.joint].moved_by = patch.correction;
  for (const JointPatch& patch : patches) {
    if (patch.offset == 0.0) continue;
    const OffsetStyle style = style_of(robot.joint(patch.joint));
    if (style == OffsetStyle::origin) move_zero_into_origins(robot, patch, changes);
    if (style == OffsetStyle::rising) changes[patch.joint].rising = patch.offset;
    if (style == OffsetStyle::ros2_control) changes[patch.joint].ros2_control = patch.offset;
  }
  return changes;
}

/// The style of a joint where the caller leaves it open.
/// @param source  the URDF
[[nodiscard]] OffsetStyle decided_style(const UrdfText& source, const Joint& joint,
                                        OffsetStyle style) {
  if (style != OffsetStyle::as_read) return style;
  return has_ros2_control_offset(source, joint) ? OffsetStyle::ros2_control : OffsetStyle::rising;
}

/// Writes the change of a joint into its element.
void edit_joint(const UrdfText& source, pugi::xml_node joint, const UrdfJointChange& change,
                std::vector<TextEdit>& edits) {
  UrdfJointEditor editor{source, joint, edits};
  editor.move_origin(change.moved_by);
  editor.shift_limits(change.limits);
  editor.add_rising(change.rising);
}

// The <mimic> elements that a calibration changes.
//
// A joint that mimics has the position t(p) = multiplier * p + offset of the position p that is published of
// the joint that drives it, also through mimic joints in between: t_between(p).  Its own element is then
//
//   multiplier = t.multiplier / t_between.multiplier,  offset = t.offset - multiplier * t_between.offset

/// Patches by joint, and where offsets go.
template <class StyleOf>
struct MimicCalibration {
  const Robot& robot;
  const std::vector<JointPatch>& patches;
  const StyleOf& style_of;

  [[nodiscard]] JointPatch patch_of(const std::string& joint) const {
    const auto found = std::find_if(patches.begin(), patches.end(),
                                    [&](const JointPatch& patch) { return patch.joint == joint; });
    return found == patches.end() ? JointPatch{joint, 0.0, {}} : *found;
  }

  /// Whether a joint, or one that it mimics, has errors of its own.
  [[nodiscard]] bool is_changed(const Joint& joint) const {
    if (!joint.mimic) return false;
    const JointPatch patch = patch_of(joint.name);
    return patch.mimic_multiplier != 0.0 || patch.mimic_offset != 0.0 ||
           is_changed(robot.joint(joint.mimic->joint));
  }

  /// t(p) of a joint.
  [[nodiscard]] Mimic by_published(const Joint& joint) const {
    Mimic total = drive(robot, joint);
    if (!joint.mimic) return total;
    const JointPatch patch = patch_of(joint.name), driver = patch_of(total.joint);
    const bool is_published =
        driver.offset != 0.0 && style_of(robot.joint(total.joint)) != OffsetStyle::origin;
    total.multiplier += patch.mimic_multiplier;
    total.offset += patch.mimic_offset;
    if (is_published) total.offset -= patch.mimic_multiplier * driver.offset;
    return total;
  }

  /// @throws InputError  if the joint between does not move with the one that drives it
  [[nodiscard]] Mimic mimic_of(const Joint& joint) const {
    const Mimic total = by_published(joint);
    const Joint& between = robot.joint(joint.mimic->joint);
    if (!between.mimic) return {between.name, total.multiplier, total.offset};
    const Mimic of = by_published(between);
    if (of.multiplier == 0.0) {
      throw InputError("joint '" + joint.name + "' mimics '" + between.name +
                       "', whose multiplier is zero: its own cannot be corrected");
    }
    const bool as_before = total.multiplier == drive(robot, joint).multiplier &&
                           of.multiplier == drive(robot, between).multiplier;
    const double multiplier =  // as it was, not rounded twice
        as_before ? joint.mimic->multiplier : total.multiplier / of.multiplier;
    return {between.name, multiplier, total.offset - multiplier * of.offset};
  }
};

/// The new <mimic> of joints that have errors of their own, or mimic one that has.
/// @param style_of  where the offset of a joint goes
/// @throws InputError  if a number cannot be written
template <class StyleOf>
[[nodiscard]] std::map<std::string, Mimic> calibrated_mimics(const Robot& robot,
                                                             const std::vector<JointPatch>& patches,
                                                             const StyleOf& style_of) {
  const MimicCalibration<StyleOf> calibration{robot, patches, style_of};
  std::map<std::string, Mimic> changed;
  for (const Joint& joint : robot.joints()) {
    if (!calibration.is_changed(joint)) continue;
    const Mimic mimic = calibration.mimic_of(joint);
    if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset)) {
      throw InputError("joint '" + joint.name +
                       "': the calibrated numbers of <mimic> are not finite");
    }
    changed.emplace(joint.name, mimic);
  }
  return changed;
}

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
  const bool finite = std::isfinite(patch.offset) && std::isfinite(patch.mimic_multiplier) &&
                      std::isfinite(patch.mimic_offset) &&
                      patch.correction.translation.allFinite() &&
                      patch.correction.rotation.allFinite();
  if (!finite) fail("the calibration of joint '" + name + "' is not finite");
  const Joint& joint = robot.joint(name);
  if (!joint.mimic && (patch.mimic_multiplier != 0.0 || patch.mimic_offset != 0.0)) {
    fail("joint '" + name + "' does not mimic another: it has no <mimic> to correct");
  }
  if (patch.offset == 0.0) return;
  if (!moves(joint.type)) {
    fail("joint '" + name + "' is " + std::string(to_string(joint.type)) +
         ": it has no position to add an offset to");
  }
  if (joint.mimic) {
    fail("joint '" + name + "' mimics another: the offset belongs to joint '" +
         drive(robot, joint).joint + "'");
  }
}

/// @throws InputError  if a patch cannot be made, or a joint has two
void check_patches(const UrdfText& source, const Robot& robot,
                   const std::vector<JointPatch>& patches) {
  std::set<std::string> patched;
  for (const JointPatch& patch : patches) {
    check_patch(source, robot, patch);
    if (patched.insert(patch.joint).second) continue;
    throw InputError(source.place(source.joint(patch.joint)).str() + ": joint '" + patch.joint +
                     "' is given two calibrations");
  }
}

}  // namespace
}  // namespace detail

std::string patch_urdf(const std::string& text, const std::string& name_for_messages,
                       const Robot& robot, const std::vector<JointPatch>& patches,
                       OffsetStyle style) {
  const detail::UrdfText source(text, name_for_messages);
  detail::check_patches(source, robot, patches);
  const auto style_of = [&](const Joint& joint) {
    return detail::decided_style(source, joint, style);
  };
  std::vector<detail::TextEdit> edits;
  const auto mimics = detail::calibrated_mimics(robot, patches, style_of);
  auto changes = detail::urdf_joint_changes(robot, patches, style_of);
  for (const auto& [name, mimic] : mimics) changes[name];  // with it, or with it alone
  for (const auto& [name, change] : changes) {
    const pugi::xml_node joint = source.joint(name);
    if (!joint) throw InputError(name_for_messages + ": no joint '" + name + "'");
    detail::edit_joint(source, joint, change, edits);
    if (const auto found = mimics.find(name); found != mimics.end()) {
      detail::UrdfJointEditor{source, joint, edits}.set_mimic(found->second);
    }
    if (change.ros2_control == 0.0) continue;
    detail::add_ros2_control_offset(source, robot.joint(name), change.ros2_control, edits);
  }
  return detail::apply_edits(text, std::move(edits));
}

OffsetPlaces offset_places(const std::string& text, const std::string& name_for_messages,
                           const Robot& robot, const std::vector<JointPatch>& patches) {
  const detail::UrdfText source(text, name_for_messages);
  OffsetPlaces places;
  const auto joints = source.robot().children("joint");
  places.has_calibration = std::any_of(joints.begin(), joints.end(), [](pugi::xml_node joint) {
    return joint.child("calibration");
  });
  for (const JointPatch& patch : patches) {
    if (patch.offset == 0.0) continue;
    const OffsetStyle style =
        detail::decided_style(source, robot.joint(patch.joint), OffsetStyle::as_read);
    (style == OffsetStyle::rising ? places.rising : places.ros2_control).push_back(patch.joint);
  }
  return places;
}

std::map<std::string, double> ros2_control_offsets(const std::string& text,
                                                   const std::string& name_for_messages) {
  const detail::UrdfText source(text, name_for_messages);
  std::map<std::string, double> offsets;
  for (const pugi::xml_node joint : detail::ros2_control_joints(source)) {
    for (const pugi::xml_node param : detail::offset_params(joint)) {
      const auto value = detail::param_text(source, param).value;
      if (value && *value != 0.0) offsets[joint.attribute("name").value()] = *value;
    }
  }
  return offsets;
}

std::map<std::string, Pose<double>> calibrated_origins(const Robot& robot,
                                                       const std::vector<JointPatch>& patches) {
  const auto in_origin = [](const Joint&) { return OffsetStyle::origin; };
  const detail::UrdfJointChanges changes = detail::urdf_joint_changes(robot, patches, in_origin);
  std::map<std::string, Pose<double>> origins;
  for (const Joint& joint : robot.joints()) {
    const auto change = changes.find(joint.name);
    origins[joint.name] =
        change == changes.end() ? joint.origin : joint.origin * change->second.moved_by;
  }
  return origins;
}

}  // namespace kinecal
