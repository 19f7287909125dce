// Installs a calibration on a robot: copies its files beside the launch file, and enters their
// names there.
//
// File names contain the date of the calibration, so earlier versions stay untouched.  Installing
// the installed calibration again changes nothing.
// Source: Fetch paper, III-C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/tools/install/launch_names.hpp"
#include "kinecal/tools/install/result_folder.hpp"

namespace kinecal {

/// The result of an installation.
struct Installation {
  std::vector<std::string> added;  ///< files, by name
  std::string backup;              ///< new name of the old launch file; empty: unchanged
};

/// Installs a result.
/// @param folder       with the robot's launch file; receives the result's files
/// @param launch       name of the launch file, usually robot.launch
/// @param diagnostics  receives warnings
/// @throws InputError   if the launch file has no place for a setting, or more than one
/// @throws OutputError  if something cannot be written; the earlier installation then stays valid
Installation install(const ResultFolder& result, const std::filesystem::path& folder,
                     const std::string& launch, const LaunchNames& names, Diagnostics& diagnostics);

/// Undoes the last installation; called again, the one before it.
/// @param force  even if files named by the earlier launch file are missing
/// @return       new name of the replaced launch file: robot.launch.undone_<n>
/// @throws InputError   if there is no backup of the launch file, or it names missing files
/// @throws OutputError  if something cannot be written; the folder is then unchanged
std::string restore_installed(const std::filesystem::path& folder, const std::string& launch,
                              bool force = false);

/// Puts another launch file in the place of the robot's: that with which it was delivered.
/// @param factory  the file
/// @return         new name of the replaced launch file, which restore_installed() puts back; empty: they are the same
/// @throws InputError   if the file is not a launch file
/// @throws OutputError  if something cannot be written; the folder is then unchanged
std::string reset_installed(const std::filesystem::path& folder, const std::string& launch,
                            const std::filesystem::path& factory);

/// The date of the installed calibration, from the launch file.
/// @throws InputError  if it is not there
[[nodiscard]] std::string installed_date(const std::filesystem::path& folder,
                                         const std::string& launch, const LaunchNames& names);

}  // namespace kinecal
