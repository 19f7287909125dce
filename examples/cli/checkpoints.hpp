// Numbers of shards on disk: what is finished is not computed again.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kinecal::cli {

/// A folder with a file for each shard and each set of numbers.  Other files in it are left alone.
class Checkpoints {
 public:
  /// @param identity  of the input: numbers of another input are never taken for these
  /// @throws OutputError  if the folder cannot be made
  Checkpoints(std::filesystem::path folder, std::string identity);

  /// Numbers of a shard; nullopt if absent or incomplete.
  [[nodiscard]] std::optional<std::vector<double>> find(const std::string& what, int shard) const;

  /// @throws OutputError  if they cannot be written
  void keep(const std::string& what, int shard, const std::vector<double>& numbers);

  /// Removes those that this run has written, and folders that are empty then: the input was wrong.
  void forget_new();
  /// Removes all of them, also those of other inputs; then, if they are empty, its folder and those that this
  /// run has created around it.
  void forget_all();

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& what, int shard) const;

  std::filesystem::path folder_;
  std::string identity_;
  std::vector<std::filesystem::path> new_;  ///< files that this run has written
  std::vector<std::filesystem::path>
      created_;  ///< folders that it has created, the inner ones first
};

}  // namespace kinecal::cli
