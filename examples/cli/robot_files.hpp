// Files of a robot's own programs that a calibration is written into: origins, homing offsets, xacro.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <set>
#include <string>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"

namespace kinecal::cli {

/// The files with their new contents; nothing is written yet.
struct RobotFiles {
  std::vector<FileSet> sets;
  Diagnostics said;  ///< what changes, and what cannot be written
};

/// Checks before the work that the files can be read and written, and are what they should be.
/// @throws InputError   if one is missing or something else
/// @throws OutputError  if one would replace an input, or its folder cannot be written to
void check_robot_files(const ResultOptions& options, const Robot& robot, const InputTexts& texts);

/// The joints whose zeros go into their servos, by the motors of --homing; none without it.
[[nodiscard]] std::set<std::string> zeros_in_servos(const RobotFileOptions& of, const Robot& robot);

/// What a calibration makes of the files.
/// @param table       the calibrated parameters
/// @param calibrated  the URDF with the calibration, as it is written
/// @throws InputError  if a file cannot hold it
[[nodiscard]] RobotFiles robot_files(const ResultOptions& options, const Robot& robot,
                                     const InputTexts& texts, const ParameterTable& table,
                                     const std::string& calibrated);

/// Writes all files or none, and prints what was said.
void write(const RobotFiles& files);

}  // namespace kinecal::cli
