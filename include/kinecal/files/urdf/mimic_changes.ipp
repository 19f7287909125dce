// The <mimic> elements that a calibration changes.
//
// A joint that mimics has the position t(p) = multiplier * p + offset of the position p that is published of
// the joint that drives it, also through mimic joints in between: t_between(p).  Its own element is then
//
//   multiplier = t.multiplier / t_between.multiplier,  offset = t.offset - multiplier * t_between.offset
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
