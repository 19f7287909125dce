// A set of files that is written whole or not at all.
//
// Everything is first written to a temporary folder inside the target folder, then renamed; what
// was there before is put back if something fails.  A reader never sees half a file.
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
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace kinecal {

/// A file could not be written: which, and why.
struct OutputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct OutputFile {
  std::string name;  ///< in the folder
  std::string content;
};

namespace detail {

[[noreturn]] inline void throw_output_error(const std::filesystem::path& path, const char* what) {
  throw OutputError(path.string() + ": " + what + ": " + std::strerror(errno));
}

/// Writes a file and waits until it is on the disk: a full disk is noticed here.
/// @param target  the name that it gets when it is whole, for messages
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

/// A lock on a folder, held while files are placed in it: of two runs one waits for the other.
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

/// A folder inside another, removed with what is in it.
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

}  // namespace detail

/// A folder into which a set of files will be written.  Making it finds out whether that is
/// possible, before any work is done; the folder is created where it is missing.
class OutputFolder {
 public:
  /// @throws OutputError  if the folder cannot be created or written to
  explicit OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    const std::filesystem::path absolute = std::filesystem::absolute(folder_).lexically_normal();
    std::filesystem::path path;
    for (const auto& part : absolute) {
      path /= part;
      if (path.empty() || std::filesystem::exists(path)) continue;
      std::error_code error;
      std::filesystem::create_directory(path, error);
      if (error) throw OutputError(folder_.string() + ": cannot be created: " + error.message());
      created_.push_back(path);
    }
    if (!std::filesystem::is_directory(folder_)) {
      throw OutputError(folder_.string() + ": is no folder");
    }
    const detail::StagingFolder can_be_written(folder_);
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Removes the folders that it made and that are still empty.
  ~OutputFolder() {
    std::error_code ignored;
    for (auto it = created_.rbegin(); it != created_.rend(); ++it) {
      std::filesystem::remove(*it, ignored);
    }
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

  /// Writes all files or none; a file of the same name is replaced.
  /// @throws OutputError  naming the file; the folder is then as it was
  void write(const std::vector<OutputFile>& files) {
    for (const OutputFile& file : files) check_target(folder_ / file.name);
    const detail::StagingFolder staging(folder_);
    for (const OutputFile& file : files) {
      detail::write_durably(staging.path() / file.name, file.content, folder_ / file.name);
    }
    const detail::FolderLock lock(folder_);
    std::vector<std::string> placed;
    try {
      for (const OutputFile& file : files) {
        keep(folder_ / file.name, staging.path() / (file.name + kBefore));
        detail::rename_file(staging.path() / file.name, folder_ / file.name);
        placed.push_back(file.name);
      }
    } catch (const OutputError&) {
      for (const std::string& name : placed) {
        put_back(staging.path() / (name + kBefore), folder_ / name);
      }
      throw;
    }
  }

 private:
  static constexpr const char* kBefore = ".before";

  static void check_target(const std::filesystem::path& target) {
    const auto status = std::filesystem::status(target);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
      throw OutputError(target.string() + ": exists and is not a file");
    }
  }

  /// A second name for a file that is about to be replaced, if there is one.
  static void keep(const std::filesystem::path& file, const std::filesystem::path& kept) {
    if (!std::filesystem::exists(file)) return;
    std::error_code error;
    std::filesystem::create_hard_link(file, kept, error);
    if (error) std::filesystem::copy_file(file, kept, error);  // a file system without links
    if (error) throw OutputError(file.string() + ": cannot be kept: " + error.message());
  }

  static void put_back(const std::filesystem::path& kept, const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::exists(kept)) {
      std::filesystem::rename(kept, file, ignored);
    } else {
      std::filesystem::remove(file, ignored);
    }
  }

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> created_;
};

}  // namespace kinecal
