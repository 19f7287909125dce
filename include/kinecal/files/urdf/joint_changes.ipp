// What a calibration changes at the joints of a URDF: origins, limits, and where offsets are held.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/files/urdf/joint_editor.ipp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/ros2_control.ipp"
#include "kinecal/kinematics/joint_state.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// The change of one joint in the text.
struct UrdfJointChange {
  Pose<double> moved_by = {};  ///< origin <- origin * moved_by
  double rising = 0.0;         ///< to be added to <calibration rising>
  double ros2_control = 0.0;   ///< to be added to the offset of <ros2_control>
  double limits = 0.0;         ///< to be added to the limits
};

using UrdfJointChanges = std::map<std::string, UrdfJointChange>;

/// Turns or slides the origin of a joint, and of those that mimic it, by its offset.
inline void move_zero_into_origins(const Robot& robot, const JointPatch& patch,
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
[[nodiscard]] inline OffsetStyle decided_style(const UrdfText& source, const Joint& joint,
                                               OffsetStyle style) {
  if (style != OffsetStyle::as_read) return style;
  return has_ros2_control_offset(source, joint) ? OffsetStyle::ros2_control : OffsetStyle::rising;
}

/// Writes the change of a joint into its element.
inline void edit_joint(const UrdfText& source, pugi::xml_node joint, const UrdfJointChange& change,
                       std::vector<TextEdit>& edits) {
  UrdfJointEditor editor{source, joint, edits};
  editor.move_origin(change.moved_by);
  editor.shift_limits(change.limits);
  editor.add_rising(change.rising);
}

}  // namespace kinecal::detail
