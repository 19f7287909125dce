// Calibration written back into the text of a URDF, in place: only numbers that change are
// rewritten, every other byte stays as it was.
//
//   frame correction             origin <- origin * correction
//   offset, OffsetStyle::rising  <calibration rising="..."> <- rising + offset, `falling` likewise
//                                where it stands
//   offset, OffsetStyle::origin  origin <- origin * correction * motion(axis, offset)
//
// The last one holds because motions along one axis add up: motion(offset) * motion(q) =
// motion(q + offset).  A joint that mimics an offset joint moves with it; folded into origins, the
// offset reaches it as motion(axis, multiplier * offset).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/urdf/urdf_edit.hpp"
#include "kinecal/kinematics/motion.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// What calibration found out about one joint.
struct JointPatch {
  std::string joint;
  double offset = 0.0;           ///< to be added to the measured position, radians or metres
  Pose<double> correction = {};  ///< of the joint's frame, behind its origin; metres
};

/// Where joint offsets go: into <calibration rising>, or into the joint's origin, which every
/// program reads.
enum class OffsetStyle { rising, origin };

namespace detail {

/// What becomes of one joint in the text.
struct UrdfJointChange {
  Pose<double> moved_by = {};  ///< origin <- origin * moved_by
  double rising = 0.0;         ///< to be added to <calibration rising>
};

using UrdfJointChanges = std::map<std::string, UrdfJointChange>;

/// @throws InputError  if the joint is not in the file or the patch makes no sense for it
inline void check_patch(const UrdfText& source, const Robot& robot, const JointPatch& patch) {
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

/// What all patches together do to each joint.
[[nodiscard]] inline UrdfJointChanges urdf_joint_changes(const UrdfText& source, const Robot& robot,
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
      moved_by = moved_by *
                 joint_pose(joint.type, joint.axis, make_motion(driven.multiplier * patch.offset));
    }
  }
  return changes;
}

}  // namespace detail

/// The text of a URDF with calibration written into it.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  what to call the text in messages: its file
/// @param robot              what parse_urdf() read from the text
/// @param patches            at most one for each joint; offsets of joints that mimic none
/// @throws InputError  if a joint is not in the text, given twice, has an offset but no position of
///                     its own, or numbers to be changed cannot be read
/// Source: robot_calibration, `calibrated_<date>.urdf`.
[[nodiscard]] inline std::string patch_urdf(const std::string& text,
                                            const std::string& name_for_messages,
                                            const Robot& robot,
                                            const std::vector<JointPatch>& patches,
                                            OffsetStyle style) {
  const UrdfText source(text, name_for_messages);
  std::vector<TextEdit> edits;
  for (const auto& [name, change] : detail::urdf_joint_changes(source, robot, patches, style)) {
    const pugi::xml_node joint = source.joint(name);
    if (!joint) throw InputError(name_for_messages + ": no joint '" + name + "'");
    detail::UrdfJointEditor editor{source, joint, edits};
    editor.move_origin(change.moved_by);
    editor.add_rising(change.rising);
  }
  return apply_edits(text, std::move(edits));
}

}  // namespace kinecal
