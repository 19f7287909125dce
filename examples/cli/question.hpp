// Questions on a terminal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace kinecal::cli {

/// What can be chosen: the answer, and a line that says what it means.
struct Choice {
  std::string answer, says;
};

[[nodiscard]] std::vector<Choice> choices(const std::vector<std::string>& answers);

/// One question; what is answered on the command line is not asked.
struct Question {
  std::string option;  ///< "--arm"
  std::string asks;
  std::vector<Choice> choices;  ///< the first is the one that Enter chooses
};

/// Says why an answer is not good; empty if it is.
using WhyNot = std::function<std::string(const std::string& answer)>;

/// Whether there is somebody who can be asked.
[[nodiscard]] bool on_a_terminal();

/// Asks until the answer is good.  Where nobody can be asked, the only choice is taken.
/// @throws InputError  where nobody can be asked and there are several; at the end of the answers
[[nodiscard]] std::string ask(const Question& question, const WhyNot& why_not);

/// What was given, or what is typed; the first choice where nobody can be asked.
[[nodiscard]] std::string ask_unless_given(const std::string& given, const Question& question,
                                           const WhyNot& why_not);

}  // namespace kinecal::cli
