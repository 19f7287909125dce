// Files of each arm, beside the URDF with all of them.
//
//   calibrated_left.urdf, ...   of robots that were joined: each alone, under its own names (joined_urdf.hpp)
//   kinematics_left.yaml, ...   of arms whose names begin with a prefix each: see kinematics_yaml.hpp
//
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/kinematics/robot.hpp"

namespace kinecal {

/// What the names of arms of a robot begin with, "left_" and "right_": the shortest prefixes before the same four names or
/// more of joints that move.  Empty of one arm.
[[nodiscard]] std::vector<std::string> arm_prefixes(const Robot& robot);

/// The files; empty of one arm.  Arms of which nothing was calibrated have no kinematics.
/// @param patches     as patch_urdf() takes them
/// @param calibrated  the URDF with the calibration
/// @param date        of the names of files; empty: without
[[nodiscard]] std::vector<OutputFile> arm_files(const Robot& robot,
                                                const std::vector<JointPatch>& patches,
                                                const std::string& calibrated,
                                                const std::string& date);

}  // namespace kinecal
