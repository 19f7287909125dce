// Calibration written back into the text of a URDF, in place: only the numbers that change are
// rewritten, every other byte stays as it was.  That is why the text is edited by hand: an XML library writes
// all of it anew, with its own blanks, quotes and order.
//
//   frame correction             origin <- origin * correction
//   offset, OffsetStyle::rising  <calibration rising="..."> <- rising + offset; `falling` likewise
//                                if present
//   offset, OffsetStyle::origin  origin <- origin * correction * motion(axis, offset);
//                                limits <- limits - offset
//   offset, OffsetStyle::ros2_control  <param name="offset"> of the joint in <ros2_control> <- its value + offset
//   mimic_multiplier, mimic_offset  <mimic multiplier="..." offset="..."> <- the URDF's + these
//
// The origin can hold the offset because motions along one axis add up: motion(offset) * motion(q) =
// motion(q + offset).  A mimic joint moves with the joint it follows; folded into origins, the
// offset reaches it as motion(axis, multiplier * offset).  Positions are then raw readings, so the limits
// move by -offset: the same poses are allowed as with `rising`.
//
// Errors of a mimic joint are linear in the reading q of the joint that drives it.  Where published positions
// include that joint's offset, p = q + offset, its <mimic offset> compensates: mimic_multiplier * (p - offset).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// The calibration of one joint.
struct JointPatch {
  std::string joint;              ///< its name in the URDF
  double offset = 0.0;            ///< to be added to the measured position, radians or metres
  Pose<double> correction = {};   ///< of the joint's frame, after its origin; metres
  double mimic_multiplier = 0.0;  ///< of a joint that mimics another: added to the URDF's
  double mimic_offset = 0.0;      ///< the same, radians or metres
};

/// Where to write joint offsets.
enum class OffsetStyle {
  rising,        ///< <calibration rising>, which few drivers read
  origin,        ///< the joint's <origin>, which every program reads
  ros2_control,  ///< <param name="offset"> of the joint in <ros2_control>: position = reading + offset
  as_read  ///< ros2_control for joints that have that offset, in radians or metres; else rising
};

/// The text of a URDF with the calibration written into it.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @param robot              what parse_urdf() read from the text
/// @param patches            at most one for each joint; no offsets for joints that mimic another
/// @throws InputError  if a joint is not in the text, has two patches, or has an offset but no
///                     position of its own; if a number that changes cannot be read; if
///                     `ros2_control` should hold an offset and does not have the joint
/// Source: robot_calibration, `calibrated_<date>.urdf`.
[[nodiscard]] std::string patch_urdf(const std::string& text, const std::string& name_for_messages,
                                     const Robot& robot, const std::vector<JointPatch>& patches,
                                     OffsetStyle style);

/// Where OffsetStyle::as_read writes the offsets of joints.
struct OffsetPlaces {
  std::vector<std::string> ros2_control;  ///< joints whose offset goes to <param name="offset">
  std::vector<std::string> rising;        ///< joints whose offset goes to <calibration rising>
  bool has_calibration = false;           ///< the URDF has <calibration>: a program reads it
};

/// @param text  the URDF, like the other arguments as patch_urdf() takes them
[[nodiscard]] OffsetPlaces offset_places(const std::string& text,
                                         const std::string& name_for_messages, const Robot& robot,
                                         const std::vector<JointPatch>& patches);

/// The nonzero offsets of joints in `ros2_control`, radians or metres as the driver has them.
/// @param text               the URDF, UTF-8
/// @param name_for_messages  name of the text in messages: its file
/// @throws InputError  if the text is not XML
[[nodiscard]] std::map<std::string, double> ros2_control_offsets(
    const std::string& text, const std::string& name_for_messages);

/// The origins of all joints as OffsetStyle::origin writes them, by joint; metres.
/// @param patches  as patch_urdf() takes them, of joints of the robot
[[nodiscard]] std::map<std::string, Pose<double>> calibrated_origins(
    const Robot& robot, const std::vector<JointPatch>& patches);

}  // namespace kinecal
