// SPDX-License-Identifier: Apache-2.0
#include "shard_folder.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "interruption.hpp"
#include "kinecal/files/checksum.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/file_set.hpp"

namespace kinecal::cli {
namespace {

/// The numbers of a file; nullopt if it does not exist.
std::optional<std::vector<double>> numbers_in(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;
  const auto size = static_cast<std::size_t>(file.tellg());
  std::vector<double> numbers(size / sizeof(double));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(numbers.data()), static_cast<std::streamsize>(size));
  if (!file || size % sizeof(double) != 0) {
    throw InputError(path.string() + ": cannot be read; remove the folder and begin again");
  }
  return numbers;
}

}  // namespace

ShardFolder::ShardFolder(std::filesystem::path folder, std::string identity, int shards,
                         const ProcessGroup& group)
    : folder_(std::move(folder)), identity_(std::move(identity)), shards_(shards), group_(group) {
  std::error_code error;
  constexpr int kTries = 50;  // another process may remove the empty folder around it
  for (int i = 0; i < kTries && !std::filesystem::is_directory(folder_); ++i) {
    std::filesystem::create_directories(folder_, error);
    if (error) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  if (!std::filesystem::is_directory(folder_)) {
    throw OutputError(folder_.string() + ": cannot be made: " + error.message());
  }
}

std::filesystem::path ShardFolder::file_of(const std::string& what, int shard) const {
  constexpr std::size_t kDigits = 24;
  return folder_ /
         fmt::format("{}.{}", sha256_text(identity_ + '\n' + what).substr(0, kDigits), shard);
}

void ShardFolder::write(const std::filesystem::path& path,
                        const std::vector<double>& numbers) const {
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}.{}", group_.rank, getpid());
  std::ofstream file(temporary, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(temporary, path, error);
  if (file && !error) return;
  if (!std::filesystem::exists(folder_)) throw SharedWorkIsDone();
  throw OutputError(path.string() + ": cannot be written");
}

std::vector<std::vector<double>> ShardFolder::exchange(const std::string& what,
                                                       const NumbersOfShard& numbers_of) const {
  for (int shard = group_.rank; shard < shards_; shard += group_.size) {
    if (Interruption::is_asked()) throw Interrupted();
    const std::filesystem::path path = file_of(what, shard);
    if (!std::filesystem::exists(path)) write(path, numbers_of(shard));
  }
  std::vector<std::vector<double>> all;
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kLong{60};
  Clock::time_point told = Clock::now();
  while (static_cast<int>(all.size()) < shards_) {
    const int shard = static_cast<int>(all.size());
    if (auto numbers = numbers_in(file_of(what, shard))) {
      all.push_back(std::move(*numbers));
      continue;
    }
    if (Interruption::is_asked()) throw Interrupted();
    if (!std::filesystem::exists(folder_)) throw SharedWorkIsDone();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (Clock::now() - told < kLong) continue;
    told = Clock::now();
    fmt::print(stderr, "note: process {} waits for file {} of process {}\n", group_.rank, shard + 1,
               shard % group_.size);
  }
  return all;
}

}  // namespace kinecal::cli
