// SPDX-License-Identifier: Apache-2.0
#include "checkpoints.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <fstream>
#include <system_error>
#include <utility>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/output_file.hpp"

namespace kinecal::cli {

Checkpoints::Checkpoints(std::filesystem::path folder, std::string identity)
    : folder_(std::move(folder)), identity_(std::move(identity)) {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (!std::filesystem::is_directory(folder_)) {
    throw OutputError(folder_.string() + ": cannot be made: " + error.message());
  }
}

std::filesystem::path Checkpoints::file_of(const std::string& what, int shard) const {
  constexpr std::size_t kDigits = 24;
  return folder_ /
         fmt::format("{}.{}", sha256_text(identity_ + '\n' + what).substr(0, kDigits), shard);
}

// A file is the number of its numbers, and these: one that a failing disk has cut off is computed again.

std::optional<std::vector<double>> Checkpoints::find(const std::string& what, int shard) const {
  std::ifstream file(file_of(what, shard), std::ios::binary | std::ios::ate);
  if (!file) return std::nullopt;
  const auto size = static_cast<std::size_t>(file.tellg());
  double count = 0.0;
  file.seekg(0).read(reinterpret_cast<char*>(&count), sizeof count);
  if (!file || static_cast<double>(size) != (count + 1.0) * sizeof(double)) return std::nullopt;
  std::vector<double> numbers(static_cast<std::size_t>(count));
  file.read(reinterpret_cast<char*>(numbers.data()),
            static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  if (!file) return std::nullopt;
  return numbers;
}

void Checkpoints::keep(const std::string& what, int shard,
                       const std::vector<double>& numbers) const {
  const std::filesystem::path path = file_of(what, shard);
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}", getpid());
  std::ofstream file(temporary, std::ios::binary);
  const auto count = static_cast<double>(numbers.size());
  file.write(reinterpret_cast<const char*>(&count), sizeof count);
  file.write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(numbers.size() * sizeof(double)));
  file.close();
  std::error_code error = std::make_error_code(std::errc::no_space_on_device);
  if (file) std::filesystem::rename(temporary, path, error);
  if (file && !error) return;
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw OutputError(folder_.string() +
                    ": a checkpoint cannot be written (is the disk full?); what " +
                    "is finished is kept, the same command resumes it");
}

}  // namespace kinecal::cli
