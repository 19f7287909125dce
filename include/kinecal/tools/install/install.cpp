// The steps of an installation: definitions of install.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/install/install.hpp"

#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/files/text_file.hpp"
#include "kinecal/tools/install/dates.ipp"
#include "kinecal/tools/install/launch_folder.ipp"
#include "kinecal/tools/install/launch_settings.ipp"
#include "kinecal/tools/install/launch_text.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The result's files, with this date in their names.
[[nodiscard]] InstalledFiles dated_files(const ResultFolder& result, const std::string& date) {
  InstalledFiles files{{with_date(result.urdf.name, date), result.urdf.content}, {}};
  for (const ResultCamera& camera : result.cameras) {
    files.cameras.push_back({with_date(camera.file.name, date), camera.file.content});
  }
  return files;
}

[[nodiscard]] std::vector<OutputFile> list(const InstalledFiles& files) {
  std::vector<OutputFile> all = files.cameras;
  all.push_back(files.urdf);
  return all;
}

/// The result's files under unused names.  A second result of the same second gets the suffix _2.
[[nodiscard]] InstalledFiles files_for(const ResultFolder& result,
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

/// Rejects a launch file that names missing files of its folder.
void check_named_files(const std::filesystem::path& launch) {
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
  throw InputError(launch.string() + ": names files that no longer exist: " + missing +
                   "; nothing was restored, --force restores it anyway");
}

}  // namespace
}  // namespace detail

Installation install(const ResultFolder& result, const std::filesystem::path& folder,
                     const std::string& launch, const LaunchNames& names,
                     Diagnostics& diagnostics) {
  detail::LaunchFolder target(folder, launch);
  target.remove_leftovers();
  const detail::LaunchText old(detail::read_text_file(target.launch()), target.launch().string());
  const detail::InstalledFiles files = detail::files_for(result, target.path());
  const std::string text =
      old.with(detail::launch_settings(result, files, target.path(), names, diagnostics));
  std::vector<OutputFile> added;
  for (const OutputFile& file : detail::list(files)) {
    if (!std::filesystem::exists(target.path() / file.name)) added.push_back(file);
  }
  Installation done;
  for (const OutputFile& file : added) done.added.push_back(file.name);
  if (text != old.text()) {
    if (target.launch_is_link()) {
      diagnostics.warnings.push_back(
          target.launch().string() + ": is a symbolic link to " +
          std::filesystem::read_symlink(target.launch()).string() +
          "; a file replaces the link, and what it names stays as it is");
    }
    done.backup = target.replace_launch(added, text);
  } else if (!added.empty()) {
    target.add(added);
  }
  return done;
}

std::string restore_installed(const std::filesystem::path& folder, const std::string& launch,
                              bool force) {
  detail::LaunchFolder target(folder, launch);
  if (!force) detail::check_named_files(target.backup());
  return target.restore();
}

std::string installed_date(const std::filesystem::path& folder, const std::string& launch,
                           const LaunchNames& names) {
  const detail::LaunchFolder target(folder, launch);
  const detail::LaunchText text(detail::read_text_file(target.launch()), target.launch().string());
  const std::string key(launch_key::kDate);
  const detail::LaunchSetting setting{key, detail::LaunchElement::param, names.at(key), "value",
                                      ""};
  Diagnostics diagnostics;
  const pugi::xml_node date = text.find(setting, diagnostics);
  diagnostics.throw_if_errors();
  return detail::LaunchText::value_of(date);
}

}  // namespace kinecal
