// Puts a calibration onto a robot: its files beside the launch file, which then names them.
//
// Files carry the calibration's date, so that no earlier version is touched.  Installing what is
// installed changes nothing.
// Source: Fetch paper, III-C.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/io/install/launch_folder.hpp"
#include "kinecal/io/install/launch_names.hpp"
#include "kinecal/io/install/launch_settings.hpp"
#include "kinecal/io/install/launch_text.hpp"
#include "kinecal/io/install/result_folder.hpp"

namespace kinecal {

/// What an installation did.
struct Installation {
  std::vector<std::string> added;  ///< files, by name
  std::string backup;              ///< what the old launch file is called; empty: it did not change
};

namespace detail {

/// A file's name with another date, or one at all: depth_camera.yaml, depth_camera_<date>.yaml.
[[nodiscard]] inline std::string with_date(const std::string& name, const std::string& date) {
  const std::filesystem::path path(name);
  std::string stem = path.stem().string();
  if (const std::string old = date_in_name(stem); !old.empty()) {
    stem.resize(stem.size() - old.size() - 1);
  }
  return stem + "_" + date + path.extension().string();
}

[[nodiscard]] inline InstalledFiles dated_files(const ResultFolder& result,
                                                const std::string& date) {
  InstalledFiles files{{with_date(result.urdf.name, date), result.urdf.content}, {}};
  for (const ResultCamera& camera : result.cameras) {
    files.cameras.push_back({with_date(camera.file.name, date), camera.file.content});
  }
  return files;
}

[[nodiscard]] inline std::vector<OutputFile> list(const InstalledFiles& files) {
  std::vector<OutputFile> all = files.cameras;
  all.push_back(files.urdf);
  return all;
}

/// The result's files under names that no other file has: of two results of the same second, the
/// second one's names end in _2.
[[nodiscard]] inline InstalledFiles files_for(const ResultFolder& result,
                                              const std::filesystem::path& folder) {
  for (int n = 1;; ++n) {
    const std::string date = n == 1 ? result.date : result.date + "_" + std::to_string(n);
    InstalledFiles files = dated_files(result, date);
    bool is_free = true;
    for (const OutputFile& file : list(files)) {
      const std::filesystem::path path = folder / file.name;
      is_free = is_free && (!std::filesystem::exists(path) || read_text_file(path) == file.content);
    }
    if (is_free) return files;
  }
}

/// Launch files have a meaning for $(...) and ${...}, XML none for control characters.
inline void check_path(const std::filesystem::path& folder) {
  for (const char c : folder.string()) {
    if (c != '$' && static_cast<unsigned char>(c) >= 0x20) continue;
    throw InputError(folder.string() +
                     ": a path with '$' or control characters cannot stand in a launch file");
  }
}

/// Refuses a launch file that names files of its folder which are not there.
inline void check_named_files(const std::filesystem::path& launch) {
  std::string missing;
  for (const std::filesystem::path& file :
       LaunchText(read_text_file(launch), launch.string()).named_files()) {
    std::error_code no_such_folder;
    const bool is_ours =
        std::filesystem::equivalent(file.parent_path(), launch.parent_path(), no_such_folder);
    if (!is_ours || std::filesystem::exists(file)) continue;
    missing += (missing.empty() ? "" : ", ") + file.filename().string();
  }
  if (missing.empty()) return;
  throw InputError(launch.string() + ": names what is not there any more: " + missing +
                   "; nothing restored, --force restores it all the same");
}

}  // namespace detail

/// Installs a result.
/// @param folder       with the robot's launch file; it will hold the result's files
/// @param launch       name of the launch file, usually robot.launch
/// @param diagnostics  is added warnings
/// @throws InputError   if the launch file has no single place for something that is to be set
/// @throws OutputError  if something cannot be written; what was installed is still installed
inline Installation install(const ResultFolder& result, const std::filesystem::path& folder,
                            const std::string& launch, const LaunchNames& names,
                            Diagnostics& diagnostics) {
  LaunchFolder target(folder, launch);
  target.remove_leftovers();
  detail::check_path(target.path());
  const LaunchText old(read_text_file(target.launch()), target.launch().string());
  const InstalledFiles files = detail::files_for(result, target.path());
  const std::string text =
      old.with(launch_settings(result, files, target.path(), names, diagnostics));
  std::vector<OutputFile> added;
  for (const OutputFile& file : detail::list(files)) {
    if (!std::filesystem::exists(target.path() / file.name)) added.push_back(file);
  }
  Installation done;
  for (const OutputFile& file : added) done.added.push_back(file.name);
  if (text != old.text()) {
    done.backup = target.replace_launch(added, text);
  } else if (!added.empty()) {
    target.add(added);
  }
  return done;
}

/// Takes back the last installation; again, the one before it.
/// @param force  also if files are missing that the launch file of before names
/// @return       what the replaced launch file is called now
/// @throws InputError, OutputError  as LaunchFolder::restore(); if files are missing
inline std::string restore_installed(const std::filesystem::path& folder, const std::string& launch,
                                     bool force = false) {
  LaunchFolder target(folder, launch);
  if (!force) detail::check_named_files(target.backup());
  return target.restore();
}

/// The date of the calibration that is installed, as the launch file says.
/// @throws InputError  if it does not say so
[[nodiscard]] inline std::string installed_date(const std::filesystem::path& folder,
                                                const std::string& launch,
                                                const LaunchNames& names) {
  const LaunchFolder target(folder, launch);
  const LaunchText text(read_text_file(target.launch()), target.launch().string());
  const std::string key(launch_key::kDate);
  const LaunchSetting setting{key, LaunchElement::param, names.at(key), "value", ""};
  Diagnostics diagnostics;
  const pugi::xml_node date = text.find(setting, diagnostics);
  diagnostics.throw_if_errors();
  return LaunchText::value_of(date);
}

}  // namespace kinecal
