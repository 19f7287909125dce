// Files that are complete before they get their names: a temporary folder, durable writes, a lock.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "kinecal/io/results/output_file.hpp"

namespace kinecal::detail {

/// @throws OutputError  with the path, what failed, and errno in words
[[noreturn]] inline void throw_output_error(const std::filesystem::path& path, const char* what) {
  throw OutputError(path.string() + ": " + what + ": " + std::strerror(errno));
}

/// Writes a file and waits until it is on the disk, so that a full disk is noticed here.
/// @param target  its name once it is complete, for messages
inline void write_durably(const std::filesystem::path& path, const std::string& content,
                          const std::filesystem::path& target) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0644);
  if (file < 0) throw_output_error(target, "cannot be created");
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t n = ::write(file, content.data() + written, content.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int why = errno;
      ::close(file);
      errno = why;
      throw_output_error(target, "cannot be written");
    }
    written += static_cast<std::size_t>(n);
  }
  if (::fsync(file) != 0 || ::close(file) != 0) throw_output_error(target, "cannot be written");
}

/// A lock on a folder, held while files are placed in it: a second run waits.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder)
      : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (folder_ < 0 || ::flock(folder_, LOCK_EX) != 0)
      throw_output_error(folder, "cannot be locked");
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() { ::close(folder_); }

 private:
  int folder_;
};

/// A temporary folder inside another, removed with its content.
class StagingFolder {
 public:
  explicit StagingFolder(const std::filesystem::path& folder) {
    std::string name = (folder / ".kinecal-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw_output_error(folder, "cannot be written to");
    path_ = name;
  }
  StagingFolder(const StagingFolder&) = delete;
  StagingFolder& operator=(const StagingFolder&) = delete;
  ~StagingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) throw_output_error(to, "cannot be written");
}

}  // namespace kinecal::detail
