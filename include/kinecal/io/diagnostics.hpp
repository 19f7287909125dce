// What is wrong with the user's files: every mistake with its place, gathered, so that all are told
// in one go.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace kinecal {

/// A mistake in a file that makes it unusable: "file:line: what is wrong; what to do".
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A place in a file; line 0: the file as a whole.
struct Place {
  std::string file;
  int line = 0;

  [[nodiscard]] std::string str() const {
    return line > 0 ? file + ":" + std::to_string(line) : file;
  }
};

struct Diagnostics {
  std::vector<std::string> errors, warnings;

  void error(const Place& place, const std::string& message) {
    errors.push_back(place.str() + ": " + message);
  }
  void warning(const Place& place, const std::string& message) {
    warnings.push_back(place.str() + ": " + message);
  }

  /// @throws InputError  with all errors, one a line, if there are any
  void throw_if_errors() const {
    if (errors.empty()) return;
    std::string all = errors.front();
    for (std::size_t i = 1; i < errors.size(); ++i) all += "\n" + errors[i];
    throw InputError(all);
  }
};

}  // namespace kinecal
