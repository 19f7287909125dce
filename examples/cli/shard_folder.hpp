// Numbers of shards in a folder that processes share and a later run reuses.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/solve/shards.hpp"
#include "process_group.hpp"

namespace kinecal::cli {

/// The user asked to stop.
struct Interrupted {};

/// Another process has written the result, and removed the folder.
struct SharedWorkIsDone {};

/// A file for each shard and each set of numbers.  Process r of n computes every n-th shard from r
/// on, and waits for the others'.
class ShardFolder {
 public:
  /// @param identity  of the input: numbers of another input are never taken for these
  /// @throws OutputError  if the folder cannot be made
  ShardFolder(std::filesystem::path folder, std::string identity, int shards,
              const ProcessGroup& group);

  /// Numbers of all shards, in their order.
  /// @throws SharedWorkIsDone  if the folder is gone
  /// @throws OutputError       if it cannot be written
  [[nodiscard]] std::vector<std::vector<double>> exchange(const std::string& what,
                                                          const NumbersOfShard& numbers_of) const;

 private:
  [[nodiscard]] std::filesystem::path file_of(const std::string& what, int shard) const;
  void write(const std::filesystem::path& path, const std::vector<double>& numbers) const;

  std::filesystem::path folder_;
  std::string identity_;
  int shards_;
  ProcessGroup group_;
};

}  // namespace kinecal::cli
