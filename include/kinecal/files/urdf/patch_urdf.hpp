// Calibration written back into the text of a URDF, in place: only the numbers that change are
// rewritten, every other byte stays as it was.  That is why the text is edited by hand: an XML library writes
// all of it anew, with its own blanks, quotes and order.
//
//   frame correction             origin <- origin * correction
//   offset, OffsetStyle::rising  <calibration rising="..."> <- rising + offset; `falling` likewise
//                                if present
//   offset, OffsetStyle::origin  origin <- origin * correction * motion(axis, offset)
//
// The last one is valid because motions along one axis add up: motion(offset) * motion(q) =
// motion(q + offset).  A mimic joint moves with the joint it follows; folded into origins, the
// offset reaches it as motion(axis, multiplier * offset).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// The calibration of one joint.
struct JointPatch {
  std::string joint;             ///< its name in the URDF
  double offset = 0.0;           ///< to be added to the measured position, radians or metres
  Pose<double> correction = {};  ///< of the joint's frame, after its origin; metres
};

/// Where to write joint offsets: into <calibration rising>, or into the joint's origin, which every
/// program reads.
enum class OffsetStyle { rising, origin };

/// The text of a URDF with the calibration written into it.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @param robot              what parse_urdf() read from the text
/// @param patches            at most one for each joint; no offsets for joints that mimic another
/// @throws InputError  if a joint is not in the text, has two patches, or has an offset but no
///                     position of its own; if a number that changes cannot be read
/// Source: robot_calibration, `calibrated_<date>.urdf`.
[[nodiscard]] std::string patch_urdf(const std::string& text, const std::string& name_for_messages,
                                     const Robot& robot, const std::vector<JointPatch>& patches,
                                     OffsetStyle style);

}  // namespace kinecal
