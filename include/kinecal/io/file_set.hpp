// A set of files that is written whole or not at all.
//
// Everything is first written to a temporary folder inside the target folder, then renamed; what was
// there before is put back if something fails.  A reader never sees half a file.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
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
inline void write_durably(const std::filesystem::path& path, const std::string& content) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0644);
  if (file < 0) throw_output_error(path, "cannot be created");
  std::size_t written = 0;
  while (written < content.size()) {
    const ssize_t n = ::write(file, content.data() + written, content.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      ::close(file);
      throw_output_error(path, "cannot be written");
    }
    written += static_cast<std::size_t>(n);
  }
  if (::fsync(file) != 0 || ::close(file) != 0) throw_output_error(path, "cannot be written");
}

}  // namespace detail

/// A folder into which a set of files will be written.  Making it finds out whether that is
/// possible, before any work is done; the folder is created where it is missing.
class OutputFolder {
 public:
  /// @throws OutputError  if the folder cannot be created or written to
  explicit OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
    std::error_code error;
    created_ = std::filesystem::create_directories(folder_, error);
    if (error) throw OutputError(folder_.string() + ": cannot be created: " + error.message());
    std::string staging = (folder_ / ".kinecal-XXXXXX").string();
    if (::mkdtemp(staging.data()) == nullptr) {
      detail::throw_output_error(folder_, "cannot be written to");
    }
    staging_ = staging;
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Leaves nothing behind but what write() has finished.
  ~OutputFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(staging_, ignored);
    if (created_) std::filesystem::remove(folder_, ignored);  // only if it is empty
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

  /// Writes all files or none; a file of the same name is replaced.
  /// @throws OutputError  naming the file; the folder is then as it was
  void write(const std::vector<OutputFile>& files) {
    for (const OutputFile& file : files) {
      detail::write_durably(staging_ / file.name, file.content);
    }
    std::vector<std::string> kept, placed;
    try {
      for (const OutputFile& file : files) {
        if (std::filesystem::exists(folder_ / file.name)) {
          move(folder_ / file.name, staging_ / (file.name + ".before"));
          kept.push_back(file.name);
        }
        move(staging_ / file.name, folder_ / file.name);
        placed.push_back(file.name);
      }
    } catch (const OutputError&) {
      std::error_code ignored;
      for (const std::string& name : placed) std::filesystem::remove(folder_ / name, ignored);
      for (const std::string& name : kept) {
        std::filesystem::rename(staging_ / (name + ".before"), folder_ / name, ignored);
      }
      throw;
    }
  }

 private:
  static void move(const std::filesystem::path& from, const std::filesystem::path& to) {
    std::error_code error;
    std::filesystem::rename(from, to, error);
    if (error) throw OutputError(to.string() + ": cannot be written: " + error.message());
  }

  std::filesystem::path folder_, staging_;
  bool created_ = false;
};

}  // namespace kinecal
