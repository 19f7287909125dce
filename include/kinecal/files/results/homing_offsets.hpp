// Zeros of joints written into the calibration file of servos, as LeRobot has it.
//
//   {"elbow_flex": {"id": 3, "drive_mode": 0, "homing_offset": -1103, "range_min": 921, "range_max": 3107}}
//
// A turn has 4096 ticks.  The joint turns as its servo counts with drive_mode 0, against it with 1:
//
//   Feetech     position = encoder - homing_offset     homing_offset <- homing_offset -+ zero
//   Dynamixel   position = encoder + homing_offset     homing_offset <- homing_offset +- zero
//
// The zero is in ticks, rounded to the nearest: half a tick is 0.04 degrees.  range_min and range_max are
// positions after homing and stay; so a position in degrees, which LeRobot counts from their middle, moves by
// the zero.
// Source: LeRobot, motors/feetech/feetech.py and motors/dynamixel/dynamixel.py, _get_half_turn_homings().
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// Makes of servos, which differ in the sign of homing_offset.
enum class ServoMake { feetech, dynamixel };

/// A patched file of homing offsets.
struct HomingPatch {
  std::string text;  ///< of the file; only the offsets that change differ
  std::vector<std::string>
      changes;  ///< "elbow_flex: homing_offset -1103 becomes -1146 (3.78 degrees are 43.01 ticks)"
  std::vector<std::string> unused;   ///< motors that are no joint of the robot
  std::vector<std::string> missing;  ///< joints with a zero but without a motor
};

/// Adds the zeros of joints to the homing offsets of the motors of the same names.
/// @param text     the file, UTF-8
/// @param file     its name, for messages
/// @param patches  as patch_urdf() takes them, of joints of the robot
/// @throws InputError  if the text is not such a file, no motor is a joint, or an offset is too large for a servo
[[nodiscard]] HomingPatch patch_homing_offsets(const std::string& text, const std::string& file,
                                               const Robot& robot,
                                               const std::vector<JointPatch>& patches,
                                               ServoMake make);

/// The motors that are joints of the robot: their zeros are in the file, so the URDF must not have them, too.
/// @throws InputError  as patch_homing_offsets()
[[nodiscard]] std::set<std::string> servo_joints(const std::string& text, const std::string& file,
                                                 const Robot& robot);

}  // namespace kinecal
