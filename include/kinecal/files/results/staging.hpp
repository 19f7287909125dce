// Files that are complete before they get their names: a temporary folder, durable writes, a lock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "kinecal/files/results/output_file.hpp"

namespace kinecal::detail {

/// @throws OutputError  with the path, what failed, and errno as text
[[noreturn]] void throw_output_error(const std::filesystem::path& path, const char* what);

/// Writes a file and waits until it is on disk, so that a full disk is noticed here.
/// @param target  its final name, for messages
void write_durably(const std::filesystem::path& path, const std::string& content,
                   const std::filesystem::path& target);

/// A lock on a folder, held while files are placed in it: a second run waits.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int folder_;
};

/// Prefix of the names of temporary folders.
inline constexpr const char* kStagingPrefix = ".kinecal-";

/// Removes a temporary folder of this user unless a process holds its lock.
void remove_if_stale(const std::filesystem::path& folder);

/// Removes the temporary folders of killed runs.
void sweep_staging_folders(const std::filesystem::path& folder);

/// A temporary folder inside another, removed with its content.  It locks itself, so a folder
/// without a lock belongs to a killed run.
class StagingFolder {
 public:
  explicit StagingFolder(const std::filesystem::path& folder);
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;
  ~StagingFolder();

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  /// @return  false if another run considered the folder stale before it was locked
  bool make(const std::filesystem::path& folder);

  std::filesystem::path path_;
  int lock_ = -1;
};

/// Gives a file its name.
/// @throws OutputError  if another has it that is to be kept
void place_file(const std::filesystem::path& from, const std::filesystem::path& to,
                Existing existing);

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace kinecal::detail
