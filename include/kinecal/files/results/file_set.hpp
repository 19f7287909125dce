// Writes a set of files completely or not at all.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/files/results/output_file.hpp"

namespace kinecal {

namespace detail {
class StagingFolder;
}  // namespace detail

/// A folder for a set of files.  The constructor checks that it is writable, before any work is
/// done, and creates it if it is missing.
class OutputFolder {
 public:
  /// @throws OutputError  if the folder cannot be created or written to
  explicit OutputFolder(std::filesystem::path folder);
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Removes the folders that it created if they are still empty.
  ~OutputFolder();

  /// The folder.
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

  /// Writes all files or none.
  /// @throws OutputError  naming the file; the folder is then unchanged
  void write(const std::vector<OutputFile>& files, Existing existing = Existing::replaced);

 private:
  void create();
  /// A temporary folder in the folder, which is created if missing.
  [[nodiscard]] detail::StagingFolder stage();

  std::filesystem::path folder_;
  std::vector<std::filesystem::path> created_;
};

/// Files of one folder.
struct FileSet {
  std::filesystem::path folder;
  std::vector<OutputFile> files;
};

/// Writes files of several folders completely or not at all; replaces files of the same name.
/// @throws OutputError  naming the file; all folders are then unchanged
void write_file_sets(const std::vector<FileSet>& sets);

/// The folder of a file: "." for a name without one.
[[nodiscard]] std::filesystem::path folder_of(const std::string& file);

/// Writes a file whole or not at all, and creates its folder if it is missing; "-" is the standard output.
/// @throws OutputError  naming the file
void write_text_file(const std::string& file, const std::string& content,
                     Existing existing = Existing::replaced);

}  // namespace kinecal
