// SPDX-License-Identifier: Apache-2.0
#include "checkpoints.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/output_file.hpp"
#include "kinecal/files/text_file.hpp"

namespace kinecal::cli {
namespace {

constexpr std::size_t kDigits = 24;    // of a file's name
constexpr std::size_t kChecksum = 64;  // characters

}  // namespace

Checkpoints::Checkpoints(std::filesystem::path folder, std::string identity)
    : folder_(std::move(folder)), identity_(std::move(identity)) {
  std::error_code error;
  for (std::filesystem::path path = folder_; !path.empty() && !std::filesystem::exists(path, error);
       path = path.parent_path()) {
    created_.push_back(path);
  }
  std::filesystem::create_directories(folder_, error);
  if (!std::filesystem::is_directory(folder_)) {
    throw OutputError(folder_.string() + ": cannot be made: " + error.message());
  }
}

std::filesystem::path Checkpoints::file_of(const std::string& what, int shard) const {
  return folder_ /
         fmt::format("{}.{}", sha256_text(identity_ + '\n' + what).substr(0, kDigits), shard);
}

// A file is the checksum of its numbers, in hexadecimal digits, and these: one that a failing disk has cut off or
// filled with something else is computed again.

std::optional<std::vector<double>> Checkpoints::find(const std::string& what, int shard) const {
  const std::filesystem::path path = file_of(what, shard);
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
  const std::string content = detail::read_text_file(path.string());
  if (content.size() < kChecksum) return std::nullopt;
  const std::string_view bytes = std::string_view(content).substr(kChecksum);
  if (bytes.size() % sizeof(double) != 0 || !content.starts_with(sha256_text(bytes))) {
    return std::nullopt;
  }
  std::vector<double> numbers(bytes.size() / sizeof(double));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// Not by OutputFolder, which looks through the folder at each call: there may be many thousand files.
void Checkpoints::keep(const std::string& what, int shard, const std::vector<double>& numbers) {
  const std::filesystem::path path = file_of(what, shard);
  std::filesystem::path temporary = path;
  temporary += fmt::format(".{}", getpid());
  const std::string_view bytes(reinterpret_cast<const char*>(numbers.data()),
                               numbers.size() * sizeof(double));
  errno = 0;
  std::ofstream file(temporary, std::ios::binary);
  file << sha256_text(bytes) << bytes;
  file.close();
  std::error_code error(file ? 0 : (errno != 0 ? errno : EIO), std::generic_category());
  if (!error) std::filesystem::rename(temporary, path, error);
  if (!error) {
    new_.push_back(path);
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(temporary, ignored);
  throw OutputError(folder_.string() + ": a checkpoint cannot be written: " + error.message() +
                    "; what is finished is kept, the same command resumes it");
}

void Checkpoints::forget_new() {
  std::error_code ignored;
  for (const std::filesystem::path& file : new_) std::filesystem::remove(file, ignored);
  new_.clear();
  for (const std::filesystem::path& folder : created_) std::filesystem::remove(folder, ignored);
}

void Checkpoints::forget_all() {
  std::error_code ignored;
  for (const auto& file : std::filesystem::directory_iterator(folder_, ignored)) {
    const std::string name = file.path().filename().string();
    const auto digits = name.find_first_not_of("0123456789abcdef");
    if (digits == kDigits && name[digits] == '.') std::filesystem::remove(file.path(), ignored);
  }
  std::filesystem::remove(folder_, ignored);
  for (const std::filesystem::path& folder : created_) std::filesystem::remove(folder, ignored);
}

}  // namespace kinecal::cli
