// Definitions of staging.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/staging.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <system_error>

namespace kinecal::detail {

void throw_output_error(const std::filesystem::path& path, const char* what) {
  throw OutputError(path.string() + ": " + what + ": " + std::strerror(errno));
}

void write_durably(const std::filesystem::path& path, const std::string& content,
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

FolderLock::FolderLock(const std::filesystem::path& folder)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0 || ::flock(folder_, LOCK_EX) != 0) throw_output_error(folder, "cannot be locked");
}

FolderLock::~FolderLock() {
  ::close(folder_);
}

void remove_if_stale(const std::filesystem::path& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (file < 0) return;
  struct stat found {};
  const bool is_ours = ::fstat(file, &found) == 0 && found.st_uid == ::geteuid();
  if (is_ours && ::flock(file, LOCK_EX | LOCK_NB) == 0) {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  ::close(file);
}

void sweep_staging_folders(const std::filesystem::path& folder) {
  const std::size_t length = std::string(kStagingPrefix).size() + 6;  // as mkdtemp() names it
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(kStagingPrefix) && name.size() == length) remove_if_stale(entry.path());
  }
}

StagingFolder::StagingFolder(const std::filesystem::path& folder) {
  sweep_staging_folders(folder);
  while (!make(folder)) {
  }
}

StagingFolder::~StagingFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

bool StagingFolder::make(const std::filesystem::path& folder) {
  std::string name = (folder / (std::string(kStagingPrefix) + "XXXXXX")).string();
  if (::mkdtemp(name.data()) == nullptr) throw_output_error(folder, "cannot be written to");
  path_ = name;
  lock_ = ::open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0 && errno != ENOENT) throw_output_error(folder, "cannot be written to");
  if (lock_ < 0) return false;
  struct stat ours {
  }, there{};
  (void)::flock(lock_, LOCK_EX);  // a file system without locks: then nothing is swept either
  const bool exists = ::fstat(lock_, &ours) == 0 && ::stat(name.c_str(), &there) == 0 &&
                      ours.st_ino == there.st_ino;
  if (!exists) ::close(lock_);
  return exists;
}

void place_file(const std::filesystem::path& from, const std::filesystem::path& to,
                Existing existing) {
  if (existing == Existing::replaced) return rename_file(from, to);
  if (::link(from.c_str(), to.c_str()) == 0) return;
  if (errno == EEXIST || std::filesystem::exists(std::filesystem::symlink_status(to))) {
    throw OutputError(to.string() +
                      ": has appeared meanwhile and is kept; use --force to replace it, "
                      "or choose another name");
  }
  rename_file(from, to);  // a file system without links
}

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) throw_output_error(to, "cannot be written");
}

}  // namespace kinecal::detail
