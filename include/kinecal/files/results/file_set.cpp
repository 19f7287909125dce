// A set of files: definitions of file_set.hpp.
//
// All files are first written to a temporary folder inside the target folder, then renamed.  If
// anything fails, the old files are restored.  A reader never sees half a file.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/file_set.hpp"

#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "kinecal/files/results/staging.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/text/characters.hpp"

namespace kinecal {

namespace detail {
namespace {

/// Suffix of the second name that a file keeps while it is replaced.
constexpr const char* kBefore = ".before";

void check_target(const std::filesystem::path& target) {
  const auto status = std::filesystem::status(target);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw OutputError(target.string() + ": exists and is not a file");
  }
}

/// Gives a second name to a file that will be replaced, if it exists.
void keep_file(const std::filesystem::path& file, const std::filesystem::path& kept) {
  if (!std::filesystem::exists(file)) return;
  std::error_code error;
  std::filesystem::create_hard_link(file, kept, error);
  if (error) std::filesystem::copy_file(file, kept, error);  // a file system without links
  if (error) throw OutputError(file.string() + ": cannot be kept: " + error.message());
}

void put_back(const std::filesystem::path& kept, const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::exists(kept)) {
    std::filesystem::rename(kept, file, ignored);
  } else {
    std::filesystem::remove(file, ignored);
  }
}

/// Files of a folder, complete in its staging folder before they get their names.
class StagedFiles {
 public:
  StagedFiles(std::filesystem::path folder, std::filesystem::path staging)
      : folder_(std::move(folder)), staging_(std::move(staging)) {}

  void stage(const std::vector<OutputFile>& files) {
    for (const OutputFile& file : files) check_target(folder_ / file.name);
    for (const OutputFile& file : files) {
      write_durably(staging_ / file.name, file.content, folder_ / file.name);
      names_.push_back(file.name);
    }
  }

  /// @throws OutputError  some files may then have their names: put_back()
  void place(Existing existing) {
    for (const std::string& name : names_) {
      if (existing == Existing::replaced) keep_file(folder_ / name, staging_ / (name + kBefore));
      place_file(staging_ / name, folder_ / name, existing);
      placed_.push_back(name);
    }
  }

  void put_back() const {
    for (const std::string& name : placed_) {
      detail::put_back(staging_ / (name + kBefore), folder_ / name);
    }
  }

 private:
  std::filesystem::path folder_, staging_;
  std::vector<std::string> names_, placed_;
};

}  // namespace
}  // namespace detail

OutputFolder::OutputFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  if (const std::string name = folder_.string(); name.find('\n') != std::string::npos) {
    throw OutputError("'" + detail::one_line(name) + "': the name of a folder has a line end");
  }
  const detail::StagingFolder can_be_written = stage();
}

detail::StagingFolder OutputFolder::stage() {
  constexpr int kTries = 50;  // the run that made the folder removes it while it is empty
  for (int i = 1;; ++i) {
    try {
      create();
      return detail::StagingFolder(folder_);
    } catch (const OutputError&) {
      if (i == kTries) throw;
    }
  }
}

void OutputFolder::create() {
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
    throw OutputError(folder_.string() + ": is not a folder");
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  for (auto it = created_.rbegin(); it != created_.rend(); ++it) {
    std::filesystem::remove(*it, ignored);
  }
}

void OutputFolder::write(const std::vector<OutputFile>& files, Existing existing) {
  const detail::StagingFolder staging = stage();
  detail::StagedFiles staged(folder_, staging.path());
  staged.stage(files);
  const detail::FolderLock lock(folder_);
  try {
    staged.place(existing);
  } catch (const OutputError&) {
    staged.put_back();
    throw;
  }
}

void write_file_sets(const std::vector<FileSet>& sets) {
  std::map<std::filesystem::path, std::vector<OutputFile>> by_folder;  // in which to lock them
  for (const FileSet& set : sets) {
    std::error_code missing;
    const auto folder = std::filesystem::weakly_canonical(set.folder, missing);
    std::vector<OutputFile>& all = by_folder[missing ? set.folder : folder];
    all.insert(all.end(), set.files.begin(), set.files.end());
  }
  std::deque<OutputFolder> folders;
  std::deque<detail::StagingFolder> staging;
  std::deque<detail::FolderLock> locks;
  std::vector<detail::StagedFiles> staged;
  for (const auto& [folder, files] : by_folder) {
    folders.emplace_back(folder);
    staging.emplace_back(folder);
    staged.emplace_back(folder, staging.back().path()).stage(files);
  }
  for (const auto& [folder, files] : by_folder) locks.emplace_back(folder);
  try {
    for (detail::StagedFiles& of : staged) of.place(Existing::replaced);
  } catch (const OutputError&) {
    for (const detail::StagedFiles& of : staged) of.put_back();
    throw;
  }
}

std::filesystem::path folder_of(const std::string& file) {
  const std::filesystem::path path(file);
  return path.has_parent_path() ? path.parent_path() : ".";
}

void write_text_file(const std::string& file, const std::string& content, Existing existing) {
  if (is_standard_output(file)) return write_standard_output(content);
  OutputFolder(folder_of(file))
      .write({{std::filesystem::path(file).filename().string(), content}}, existing);
}

}  // namespace kinecal
