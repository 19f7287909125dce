// SPDX-License-Identifier: Apache-2.0
#include "study_journal.hpp"

#include <fmt/core.h>
#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <sstream>
#include <utility>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/report/residual_rows.ipp"

namespace kinecal::cli {
namespace {

/// Files of journals in a folder, in order.
std::vector<std::filesystem::path> journals_in(const std::filesystem::path& folder) {
  std::map<std::string, std::filesystem::path> found;
  std::error_code missing;
  for (const auto& file : std::filesystem::directory_iterator(folder, missing)) {
    const std::string name = file.path().filename().string();
    if (name.starts_with("journal.") && name.ends_with(".csv")) found[name] = file.path();
  }
  std::vector<std::filesystem::path> all;
  for (const auto& [name, path] : found) all.push_back(path);
  return all;
}

constexpr std::size_t kChecksum = 16;  // characters

std::string checksum_of(const std::string& content) {
  return sha256_text(content).substr(0, kChecksum);
}

/// The trial of a line; nullopt if the line was cut off or changed.
std::optional<StudyTrial> trial_of(const std::string& line) {
  constexpr std::string_view kEnd = ",end";
  constexpr std::size_t kAfter = 1 + kChecksum + kEnd.size();
  if (!line.ends_with(kEnd) || line.size() < kAfter) return std::nullopt;
  const std::string content = line.substr(0, line.size() - kAfter);
  if (line.substr(content.size() + 1, kChecksum) != checksum_of(content)) return std::nullopt;
  std::vector<double> numbers;
  std::istringstream words(content);
  for (std::string word; std::getline(words, word, ',');) {
    double number = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    numbers.push_back(number);
  }
  constexpr std::size_t kBefore = 13;
  if (numbers.size() < kBefore) return std::nullopt;
  const auto integer = [&](std::size_t i) { return static_cast<int>(numbers[i]); };
  StudyTrial trial;
  trial.seconds = numbers[0];
  trial.job = {integer(1), integer(2), integer(3)};
  trial.converged = numbers[4] != 0.0;
  trial.ruined = integer(5);
  trial.left_out = integer(6);
  trial.position = numbers[7];
  trial.rotation = numbers[8];
  trial.reprojection = numbers[9];
  trial.systematic = numbers[10];
  trial.nonlinearity = numbers[11];
  trial.solves = integer(12);
  trial.values.assign(numbers.begin() + kBefore, numbers.end());
  return trial;
}

}  // namespace

std::string journal_line(const StudyTrial& trial) {
  const std::string content = fmt::format("{},{}", trial.seconds, trial_line(trial));
  return content + "," + checksum_of(content) + ",end\n";
}

void read_journal(const std::string& text, StudyTrials& trials) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (const auto trial = trial_of(line)) trials[trial->job] = *trial;
  }
}

std::string trial_line(const StudyTrial& trial) {
  std::string line = fmt::format(
      "{},{},{},{},{},{},{},{},{},{},{},{}", trial.job.robot, trial.job.poses, trial.job.repeat,
      trial.converged ? 1 : 0, trial.ruined, trial.left_out, trial.position, trial.rotation,
      trial.reprojection, trial.systematic, trial.nonlinearity, trial.solves);
  for (const double value : trial.values) line += fmt::format(",{}", value);
  return line;
}

std::string trial_columns(const std::vector<std::string>& parameters) {
  std::string line =
      "robot,poses,repeat,converged,ruined,left_out,position,rotation,reprojection,systematic,"
      "nonlinearity,"
      "solves";
  for (const std::string& name : parameters) line += "," + detail::csv_cell(name);
  return line;
}

StudyJournal::StudyJournal(std::filesystem::path folder, std::string identity, int process)
    : folder_(std::move(folder)),
      identity_("# " + std::move(identity)),
      own_(folder_ / fmt::format("journal.{}.csv", process)) {
  for (const std::filesystem::path& path : journals_in(folder_)) {
    std::ifstream file(path);
    std::string first;
    if (!std::getline(file, first) || identity_.starts_with(first)) continue;  // or cut off
    throw InputError(path.string() +
                     ": is of another study, which was interrupted; finish that one, use --force "
                     "to forget it, or choose another folder");
  }
  std::error_code missing;
  const bool is_new =
      !std::filesystem::exists(own_) || std::filesystem::file_size(own_, missing) == 0;
  file_.open(own_, std::ios::app);
  file_ << (is_new ? identity_ : "") << "\n" << std::flush;  // ends a line that was cut off, too
  if (!file_) throw OutputError(own_.string() + ": cannot be written");
}

StudyTrials StudyJournal::read() const {
  StudyTrials trials;
  for (const std::filesystem::path& path : journals_in(folder_)) {
    read_journal(detail::read_text_file(path.string()), trials);
  }
  return trials;
}

void StudyJournal::add(const StudyTrial& trial) {
  const std::lock_guard lock(mutex_);
  file_ << journal_line(trial) << std::flush;
  if (!file_) throw OutputError(own_.string() + ": cannot be written");
}

void StudyJournal::remove(const std::filesystem::path& folder, const std::string& but) {
  for (const std::filesystem::path& path : journals_in(folder)) {
    std::ifstream file(path);
    std::string first;
    if (!but.empty() && std::getline(file, first) && first == "# " + but) continue;
    std::filesystem::remove(path);
  }
}

}  // namespace kinecal::cli
