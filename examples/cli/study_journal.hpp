// The trials of a study on disk.  Each is stored when it is done, so nothing is lost, and running
// the same study again continues it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "kinecal/study/repeatability.hpp"

namespace kinecal::cli {

/// Finished trials, by their jobs.
using StudyTrials = std::map<StudyJob, StudyTrial>;

/// A journal of one process in the folder of a study: journal.<process>.csv
class StudyJournal {
 public:
  /// @param identity  says what is studied: a journal of another study is refused
  /// @throws InputError   if there is a journal of another study, with what to do
  /// @throws OutputError  if the folder cannot be written
  StudyJournal(std::filesystem::path folder, std::string identity, int process);

  /// Trials of all processes that were found.
  [[nodiscard]] StudyTrials read() const;
  /// Appends a trial.  Any thread may call it.
  /// @throws OutputError  if it cannot be written
  void add(const StudyTrial& trial);

  /// Removes the journals of a folder, but those of the study with this identity.
  static void remove(const std::filesystem::path& folder, const std::string& but = {});

 private:
  std::filesystem::path folder_;
  std::string identity_;
  std::filesystem::path own_;
  std::ofstream file_;
  std::mutex mutex_;
};

/// A trial as a line of a journal.
[[nodiscard]] std::string journal_line(const StudyTrial& trial);
/// Adds the trials of a journal's lines, but one that was cut off.
void read_journal(const std::string& text, StudyTrials& trials);

/// A trial as a line of a table: its numbers to the last bit, without times.
[[nodiscard]] std::string trial_line(const StudyTrial& trial);
/// The names of the columns of that line.
[[nodiscard]] std::string trial_columns(const std::vector<std::string>& parameters);

}  // namespace kinecal::cli
