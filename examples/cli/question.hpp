// Questions on a terminal.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace kinecal::cli {

/// A possible answer, with a one-line explanation.
struct Choice {
  std::string answer, says;
};

[[nodiscard]] std::vector<Choice> choices(const std::vector<std::string>& answers);

/// A question, asked unless its option is given on the command line.
struct Question {
  std::string option;  ///< "--arm"
  std::string asks;
  std::vector<Choice> choices;  ///< Enter chooses the first one
};

/// Says why an answer is not good; empty if it is.
using WhyNot = std::function<std::string(const std::string& answer)>;

/// Whether the standard input is a terminal, so that questions can be asked.
[[nodiscard]] bool on_a_terminal();

/// Asks until the answer is good.  Without a terminal, takes the only choice.
/// @throws InputError  without a terminal, if there is not exactly one choice; if the input ends;
///                     or if there is no choice and the answer is empty
[[nodiscard]] std::string ask(const Question& question, const WhyNot& why_not);

/// The given answer, or else the typed one; without a terminal, the first choice.
[[nodiscard]] std::string ask_unless_given(const std::string& given, const Question& question,
                                           const WhyNot& why_not);

}  // namespace kinecal::cli
