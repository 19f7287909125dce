// SPDX-License-Identifier: Apache-2.0
#include "question.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <charconv>
#include <iostream>
#include <optional>

#include "kinecal/files/diagnostics.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

std::string listed(const std::vector<Choice>& all) {
  std::string text;
  for (const Choice& choice : all) text += (text.empty() ? "" : ", ") + choice.answer;
  return text;
}

void print_question(const Question& question) {
  if (question.choices.size() == 1) {
    say("{} [{}]: ", question.asks, question.choices.front().answer);
    std::fflush(stdout);
    return;
  }
  say("{}\n", question.asks);
  int number = 0;
  for (const Choice& choice : question.choices) {
    say("  {}  {}{}{}\n", ++number, choice.answer, choice.says.empty() ? "" : ": ", choice.says);
  }
  say("{}: ", question.choices.empty() ? "name" : "number or name [1]");
  std::fflush(stdout);
}

/// The meaning of a typed answer; nothing if the question must be asked again.
std::optional<std::string> understood(const Question& question, const std::string& line) {
  const std::vector<Choice>& choices = question.choices;
  if (line.empty() && !choices.empty()) return choices.front().answer;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  if (error == std::errc() && end == line.data() + line.size()) {
    if (number >= 1 && number <= choices.size()) return choices[number - 1].answer;
    return std::nullopt;
  }
  return line.empty() ? std::nullopt : std::optional(line);
}

}  // namespace

std::vector<Choice> choices(const std::vector<std::string>& answers) {
  std::vector<Choice> all;
  for (const std::string& answer : answers) all.push_back({answer, ""});
  return all;
}

bool on_a_terminal() {
  return isatty(STDIN_FILENO) != 0;
}

std::string ask(const Question& question, const WhyNot& why_not) {
  if (!on_a_terminal()) {
    if (question.choices.size() == 1) {
      say("{} {} (the only one)\n", question.option, question.choices.front().answer);
      return question.choices.front().answer;
    }
    throw InputError(question.option + " is required, because the input is not a terminal" +
                     (question.choices.empty() ? "; no link of the URDF looks like one"
                                               : "; use one of " + listed(question.choices)));
  }
  for (;;) {
    print_question(question);
    std::string line;
    if (!std::getline(std::cin, line)) {
      throw InputError(question.option + ": not answered; nothing is written");
    }
    const auto begin = line.find_first_not_of(" \t\r");
    line = begin == std::string::npos
               ? ""
               : line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
    if (line.empty() && question.choices.empty()) {
      throw InputError(question.option +
                       ": not answered, and the URDF suggests nothing; nothing "
                       "is written");
    }
    const auto answer = understood(question, line);
    if (!answer) {
      say("  there is no such number\n");
    } else if (const std::string why = why_not(*answer); !why.empty()) {
      say("  {}\n", why);
    } else {
      return *answer;
    }
  }
}

std::string ask_unless_given(const std::string& given, const Question& question,
                             const WhyNot& why_not) {
  if (!given.empty()) return given;
  return on_a_terminal() ? ask(question, why_not) : question.choices.front().answer;
}

}  // namespace kinecal::cli
