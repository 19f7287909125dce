// Errors in the user's files, each with its source location; collected and reported together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace kinecal {

/// An error that makes a file unusable: "file:line: what is wrong; what to do".
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A line of a file, from 1; line 0 is the file as a whole.
struct SourceLocation {
  std::string file;  ///< path, as the user gave it
  int line = 0;      ///< from 1

  /// "file:line", or "file" without a line.
  [[nodiscard]] std::string str() const {
    return line > 0 ? file + ":" + std::to_string(line) : file;
  }
};

/// Findings of readers: "file:line: message".  With errors, the result is incomplete.
struct Diagnostics {
  std::vector<std::string> errors;     ///< make the input unusable
  std::vector<std::string> warnings;   ///< skipped or assumed input; the result is not affected
  std::vector<std::string> doubts;     ///< looks wrong but could be right: check the result before
                                       ///< you use it
  std::vector<std::string> refutable;  ///< those of the doubts that a fit to the noise refutes
  std::vector<std::string> notes;      ///< findings that need no action

  /// Adds an error.
  void error(const SourceLocation& place, const std::string& message) {
    errors.push_back(place.str() + ": " + message);
  }
  /// Adds a warning.
  void warning(const SourceLocation& place, const std::string& message) {
    warnings.push_back(place.str() + ": " + message);
  }

  /// Adds a doubt.
  void doubt(const SourceLocation& place, const std::string& message) {
    doubts.push_back(place.str() + ": " + message);
  }

  /// Adds a doubt that a fit to the noise refutes.
  void refutable_doubt(const SourceLocation& place, const std::string& message) {
    doubt(place, message);
    refutable.push_back(doubts.back());
  }

  /// Adds a note.
  void note(const SourceLocation& place, const std::string& message) {
    notes.push_back(place.str() + ": " + message);
  }

  /// @throws InputError  with all errors, one per line, if there are any
  void throw_if_errors() const {
    if (errors.empty()) return;
    std::string all = errors.front();
    for (std::size_t i = 1; i < errors.size(); ++i) all += "\n" + errors[i];
    throw InputError(all);
  }
};

}  // namespace kinecal
