// The changes of a URDF's joints: definitions of patch_urdf.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/urdf/patch_urdf.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/urdf/joint_changes.ipp"
#include "kinecal/files/urdf/mimic_changes.ipp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal {

namespace detail {
namespace {

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
