// Changes the folder of a robot's launch file so that the robot can start at any moment: even after
// an interruption, the launch file is the old one or the new one, and the files that it names
// exist.
//
// New files are written to a temporary folder, synchronized to disk, and renamed; the launch file
// comes last.  The old launch file stays as robot.launch.backup_<n>; the largest n is the newest,
// whatever the clock says.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/staging.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

class LaunchFolder {
 public:
  /// Locks the folder: waits for others that change it; others wait until this is destroyed.
  /// @param folder  absolute, or relative to the working folder
  /// @param launch  name of the launch file in it
  /// @throws InputError   if the folder or the launch file is missing
  /// @throws OutputError  if the folder cannot be locked
  LaunchFolder(const std::filesystem::path& folder, const std::string& launch)
      : folder_(checked(folder, launch)), launch_(launch), lock_(folder_) {}

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  [[nodiscard]] std::filesystem::path launch() const { return folder_ / launch_; }

  [[nodiscard]] bool launch_is_link() const { return std::filesystem::is_symlink(launch()); }

  /// Removes the leftovers of an interrupted run.
  void remove_leftovers() const {
    std::error_code ignored;
    std::filesystem::remove_all(folder_ / kStaging, ignored);
  }

  /// Adds files and replaces the launch file; keeps the old one.
  /// @param files  new ones, with names not yet in the folder
  /// @return       new name of the old launch file
  /// @throws OutputError  naming the file; the folder is then unchanged
  std::string replace_launch(const std::vector<OutputFile>& files, const std::string& text) {
    const Staging staging(folder_);
    New placed{folder_, {}};
    write_like_launch(staging, {{launch_, text}});
    place(staging, files, placed);
    // A backup equal to the launch file comes from a run that stopped between the two.
    int n = newest_backup();
    if (n == 0 || read_text_file(folder_ / backup_name(n)) != read_text_file(launch())) {
      if (n == kMostBackups) {
        throw OutputError(launch().string() + ": " + backup_name(n) +
                          " has the last number; rename it");
      }
      keep(staging, backup_name(++n));
      placed.names.push_back(backup_name(n));
    }
    sync_folder();
    rename_file(staging.path / launch_, launch());
    placed.names.clear();
    sync_folder();
    return backup_name(n);
  }

  /// Adds files; does not change the launch file.
  /// @throws OutputError  naming the file; the folder is then unchanged
  void add(const std::vector<OutputFile>& files) {
    const Staging staging(folder_);
    New placed{folder_, {}};
    place(staging, files, placed);
    sync_folder();
    placed.names.clear();
  }

  /// The launch file that restore() would restore: the newest backup.
  /// @throws InputError  if it is missing
  [[nodiscard]] std::filesystem::path backup() const {
    return folder_ / backup_name(checked_backup());
  }

  /// Replaces the launch file by the newest backup; keeps it as robot.launch.undone_<n>: n is the
  /// number of the backup, or the next free one.
  /// @return  new name of the replaced launch file
  /// @throws InputError   if there is no backup
  /// @throws OutputError  naming the file; the folder is then unchanged
  std::string restore() {
    const std::string text = read_text_file(launch());
    const int n = checked_backup();
    for (int k = newest_backup(); k > n; k = newest_backup()) remove(backup_name(k));
    std::string undone;
    for (int k = n; undone.empty() || is_other(undone, text); ++k) {
      undone = launch_ + ".undone_" + std::to_string(k);
    }
    const Staging staging(folder_);
    keep(staging, undone);
    sync_folder();
    rename_file(folder_ / backup_name(n), launch());
    sync_folder();
    return undone;
  }

 private:
  static constexpr const char* kStaging = ".kinecal-install";
  static constexpr int kMostBackups = 999'999'999;  ///< files with larger numbers are no backups

  /// A temporary folder.  Its name is always the same, so that interrupted runs do not pile up.
  struct Staging {
    explicit Staging(const std::filesystem::path& folder) : path(folder / kStaging) {
      std::error_code error;
      std::filesystem::remove_all(path, error);
      if (::mkdir(path.c_str(), 0700) != 0) {
        throw_output_error(folder, "cannot be written to");
      }
    }
    Staging(const Staging&) = delete;
    Staging& operator=(const Staging&) = delete;
    ~Staging() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
    std::filesystem::path path;
  };

  /// New files; removed again unless the change succeeds.
  struct New {
    const std::filesystem::path& folder;
    std::vector<std::string> names;
    ~New() {
      std::error_code ignored;
      for (const std::string& name : names) std::filesystem::remove(folder / name, ignored);
    }
  };

  [[nodiscard]] static std::filesystem::path checked(const std::filesystem::path& folder,
                                                     const std::string& launch) {
    namespace fs = std::filesystem;
    fs::path absolute = (fs::absolute(folder) / "").lexically_normal().parent_path();
    std::error_code error;
    if (!fs::is_directory(absolute, error)) {
      throw InputError(folder.string() + ": is not a folder; give the one with the launch file");
    }
    if (launch.empty() || fs::path(launch).filename() != launch) {
      throw InputError("launch file '" + launch + "': is not the name of a file in " +
                       folder.string());
    }
    if (fs::exists(absolute / launch, error)) return absolute;
    std::vector<std::string> others;
    for (const auto& entry : fs::directory_iterator(absolute, error)) {
      others.push_back(entry.path().filename().string());
    }
    const std::string meant = did_you_mean(launch, others);
    throw InputError((folder / launch).string() + ": is not there" +
                     (meant.empty() ? "; give its name with --launch.  A robot without a launch "
                                      "file of ROS 1 needs no installation: give calibrated.urdf "
                                      "to robot_state_publisher (ROS 2), or the file of "
                                      "'calibrate --kinematics' to the driver (UR)"
                                    : meant));
  }

  /// True if a file exists with other content.
  [[nodiscard]] bool is_other(const std::string& name, const std::string& content) const {
    return std::filesystem::exists(folder_ / name) && read_text_file(folder_ / name) != content;
  }

  [[nodiscard]] std::string backup_name(int n) const {
    return launch_ + ".backup_" + std::to_string(n);
  }

  /// Number of the newest backup, from 1; 0 if absent.
  [[nodiscard]] int newest_backup() const {
    const std::string start = launch_ + ".backup_";
    int newest = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with(start)) continue;
      int n = 0;
      const char* const end = name.data() + name.size();
      const auto [stop, error] = std::from_chars(name.data() + start.size(), end, n);
      if (error == std::errc() && stop == end && n <= kMostBackups) newest = std::max(newest, n);
    }
    return newest;
  }

  /// Number of the newest backup that differs from the launch file.  An equal one comes from an
  /// interrupted run and would restore nothing.
  /// @throws InputError  if it is missing
  [[nodiscard]] int checked_backup() const {
    const std::string text = read_text_file(launch());
    for (int n = newest_backup(); n > 0; --n) {
      const std::filesystem::path path = folder_ / backup_name(n);
      const bool is_there = std::filesystem::exists(std::filesystem::symlink_status(path));
      if (is_there && read_text_file(path) != text) return n;
    }
    throw InputError(launch().string() + ": there is nothing to restore: no " + backup_name(1) +
                     " or later stands beside it");
  }

  /// Writes files with the permissions of the launch file.
  void write_like_launch(const Staging& staging, const std::vector<OutputFile>& files) const {
    struct stat like = {};
    if (::stat(launch().c_str(), &like) != 0) throw_output_error(launch(), "cannot be read");
    for (const OutputFile& written : files) {
      const std::filesystem::path path = staging.path / written.name;
      const std::filesystem::path target = folder_ / written.name;
      write_durably(path, written.content, target);
      const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
      if (file < 0) throw_output_error(target, "cannot be read");
      // Only root may change the owner; for others this may fail.
      [[maybe_unused]] const int may_fail = ::fchown(file, like.st_uid, like.st_gid);
      const bool done = ::fchmod(file, like.st_mode & 0777) == 0 && ::fsync(file) == 0;
      if (::close(file) != 0 || !done) throw_output_error(target, "cannot be written");
    }
  }

  void place(const Staging& staging, const std::vector<OutputFile>& files, New& placed) const {
    write_like_launch(staging, files);
    for (const OutputFile& file : files) {
      rename_file(staging.path / file.name, folder_ / file.name);
      placed.names.push_back(file.name);
    }
  }

  /// Gives the launch file a second name.  For a symbolic link, copies the content, because its
  /// target may change later.
  void keep(const Staging& staging, const std::string& name) const {
    const std::filesystem::path kept = staging.path / name;
    if (launch_is_link() || ::link(launch().c_str(), kept.c_str()) != 0) {  // or no links here
      write_like_launch(staging, {{name, read_text_file(launch())}});
    }
    rename_file(kept, folder_ / name);
  }

  void remove(const std::string& name) const {
    if (::unlink((folder_ / name).c_str()) != 0) {
      throw_output_error(folder_ / name, "cannot be removed");
    }
  }

  /// Waits until the folder's entries are on disk.
  void sync_folder() const {
    const int folder = ::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool done = folder >= 0 && ::fsync(folder) == 0;
    if (folder >= 0) ::close(folder);
    if (!done) throw_output_error(folder_, "cannot be written to");
  }

  std::filesystem::path folder_;
  std::string launch_;
  FolderLock lock_;
};

}  // namespace kinecal::detail
