// Installs a calibration on a robot: its files beside the launch file, and their names in it.
//
// The names of the files contain the date of the calibration, so earlier versions stay untouched.
// Installing the installed calibration again changes nothing.
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

/// What an installation did.
struct Installation {
  std::vector<std::string> added;  ///< files, by name
  std::string backup;              ///< new name of the old launch file; empty: it did not change
};

/// Installs a result.
/// @param folder       with the robot's launch file; it will hold the result's files
/// @param launch       name of the launch file, usually robot.launch
/// @param diagnostics  gets warnings
/// @throws InputError   if the launch file has no place for a setting, or more than one
/// @throws OutputError  if something cannot be written; the earlier installation then still holds
Installation install(const ResultFolder& result, const std::filesystem::path& folder,
                     const std::string& launch, const LaunchNames& names, Diagnostics& diagnostics);

/// Undoes the last installation; called again, the one before it.
/// @param force  also if files are missing that the earlier launch file names
/// @return       new name of the replaced launch file: robot.launch.undone_<n>
/// @throws InputError   if there is no backup of the launch file, or it names missing files
/// @throws OutputError  if something cannot be written; the folder is then as it was
std::string restore_installed(const std::filesystem::path& folder, const std::string& launch,
                              bool force = false);

/// The date of the installed calibration, from the launch file.
/// @throws InputError  if the launch file does not have it
[[nodiscard]] std::string installed_date(const std::filesystem::path& folder,
                                         const std::string& launch, const LaunchNames& names);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/tools/install/install.ipp"
#endif
