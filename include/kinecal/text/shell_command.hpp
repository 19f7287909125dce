// Commands that people paste into a shell, and words that a shell reads as they are.
//
// Names and files in a command come from others: `touch x` in a joint's name must stay a name.  So a command is
// made of words, and quotes each when it becomes text.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/linkage.hpp"

namespace kinecal {

/// A word as a POSIX shell reads it: as it is if it has plain characters only; 'in quotes'; or $'with escapes' if it has
/// characters that a terminal or a page would not show, such as line ends.
/// Source: POSIX.1-2024, Shell Command Language, 2.2.
[[nodiscard]] std::string shell_word(std::string_view word);

/// A file name that no program takes for an option: ./-name.
[[nodiscard]] inline std::string shell_file(const std::string& name) {
  return name.starts_with('-') ? "./" + name : name;
}

/// A command as words: {"kinecal", "calibrate", "--hold", name}.
class ShellCommand {
 public:
  ShellCommand() = default;
  /// Implicit, so that a list of words is a command.
  ShellCommand(std::initializer_list<std::string> words) : words_(words) {}

  /// Appends words: add({"--output", folder}).
  ShellCommand& add(const ShellCommand& more) {
    words_.insert(words_.end(), more.words_.begin(), more.words_.end());
    return *this;
  }
  /// Appends an option and its values: --hold a b; nothing without values.  A value that looks like an option is joined to
  /// it: --hold=-c.
  ShellCommand& add_option(const std::string& option, const std::vector<std::string>& values);
  /// As add_option(), for an option whose values are lists of names: name_list.hpp.
  ShellCommand& add_names(const std::string& option, const std::vector<std::string>& names);

  /// True if it has no words.
  [[nodiscard]] bool empty() const { return words_.empty(); }
  /// True if a word is in the command.
  [[nodiscard]] bool has(const std::string& word) const {
    return std::find(words_.begin(), words_.end(), word) != words_.end();
  }
  /// One line for a shell, each word as shell_word() writes it.
  [[nodiscard]] std::string str() const;

 private:
  std::vector<std::string> words_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/text/shell_command.ipp"
#endif
