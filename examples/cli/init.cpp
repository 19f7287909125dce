// kinecal init: a first configuration, by a few questions.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <unistd.h>

#include <charconv>
#include <filesystem>
#include <iostream>
#include <optional>
#include <utility>

#include "commands.hpp"
#include "kinecal/io/init/initial_config.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"

namespace kinecal::cli {
namespace {

/// What can be chosen: the answer, and a line that says what it means.
struct Choice {
  std::string answer, says;
};

std::vector<Choice> choices(const std::vector<std::string>& answers) {
  std::vector<Choice> all;
  for (const std::string& answer : answers) all.push_back({answer, ""});
  return all;
}

std::string listed(const std::vector<Choice>& all) {
  std::string text;
  for (const Choice& choice : all) text += (text.empty() ? "" : ", ") + choice.answer;
  return text;
}

/// One question; what is answered on the command line is not asked.
struct Question {
  std::string option;  ///< "--arm"
  std::string asks;
  std::vector<Choice> choices;  ///< the first is the one that Enter chooses
};

void print(const Question& question) {
  fmt::print("{}\n", question.asks);
  int number = 0;
  for (const Choice& choice : question.choices) {
    fmt::print("  {}  {}{}{}\n", ++number, choice.answer, choice.says.empty() ? "" : ": ",
               choice.says);
  }
  fmt::print("{}: ", question.choices.empty() ? "name" : "number or name [1]");
  std::fflush(stdout);
}

/// What an answer typed stands for; nothing if it must be asked again.
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

/// Asks on the terminal.  Where there is none, the only choice is taken, and several are an error.
/// @param valid  whether a name is a good answer; it says why if not
template <class Valid>
std::string ask(const Question& question, const Valid& valid) {
  if (isatty(STDIN_FILENO) == 0) {
    if (question.choices.size() == 1) {
      fmt::print("{} {} (the only one)\n", question.option, question.choices.front().answer);
      return question.choices.front().answer;
    }
    throw InputError(question.option + " is required where nobody can be asked" +
                     (question.choices.empty() ? "; no link of the URDF looks like one"
                                               : "; one of " + listed(question.choices)));
  }
  for (;;) {
    print(question);
    std::string line;
    if (!std::getline(std::cin, line)) {
      throw InputError(question.option + ": not answered; nothing is written");
    }
    const auto begin = line.find_first_not_of(" \t\r");
    line = begin == std::string::npos
               ? ""
               : line.substr(begin, line.find_last_not_of(" \t\r") - begin + 1);
    const auto answer = understood(question, line);
    if (!answer) {
      fmt::print("  there is no such number\n");
    } else if (const std::string why = valid(*answer); !why.empty()) {
      fmt::print("  {}\n", why);
    } else {
      return *answer;
    }
  }
}

std::string ask_link(const Robot& robot, const Question& question) {
  return ask(question, [&](const std::string& link) -> std::string {
    if (robot.has_link(link)) return "";
    return fmt::format("the robot has no link '{}'{}", link,
                       did_you_mean(link, robot.link_names()));
  });
}

std::string check_target(const std::string& word) {
  if (init_target(word)) return "";
  std::vector<std::string_view> words;
  for (const InitTargetWord& known : kInitTargets) words.push_back(known.word);
  return fmt::format("'{}' is no target{}", word, did_you_mean(word, words));
}

/// One or two targets: the floor may come with another one.
void answer_targets(const InitOptions& options, InitAnswers& answers) {
  std::vector<std::string> words = options.targets;
  if (words.empty()) {
    Question question{"--target", "What is the robot measured against?", {}};
    for (const InitTargetWord& known : kInitTargets) {
      question.choices.push_back({std::string(known.word), std::string(known.says)});
    }
    words = {ask(question, check_target)};
    const InitTarget target = *init_target(words.front());
    if (needs_camera(target) && target != InitTarget::ground && isatty(STDIN_FILENO) != 0 &&
        options.camera_type != "camera2d") {
      const Question floor{"--target", "Does the camera see the floor too, in samples of its own?",
                           choices({"no", "yes"})};
      const std::string seen = ask(floor, [](const std::string& word) -> std::string {
        return word == "no" || word == "yes" ? "" : "yes or no";
      });
      if (seen == "yes") words.push_back("ground");
    }
  }
  bool is_chosen = false;
  for (const std::string& word : words) {
    if (const std::string why = check_target(word); !why.empty()) {
      throw InputError("--target: " + why);
    }
    const InitTarget target = *init_target(word);
    if (target == InitTarget::ground) {
      answers.with_ground = true;
    } else if (is_chosen && target != answers.target) {
      throw InputError(
          fmt::format("--target: {} and {} cannot be had in one configuration; only "
                      "ground goes with another target",
                      to_string(answers.target), word));
    } else {
      answers.target = target;
      is_chosen = true;
    }
  }
  if (is_chosen) return;
  answers.target = InitTarget::ground;
  answers.with_ground = false;
}

void answer_camera(const Robot& robot, const InitOptions& options, InitAnswers& answers) {
  if (answers.camera.empty()) {
    answers.camera =
        ask_link(robot, {"--camera", "Which link is the camera's optical frame (z ahead, y down)?",
                         choices(propose_cameras(robot))});
  }
  const bool floor = answers.with_ground || answers.target == InitTarget::ground;
  if (!options.camera_type.empty()) {
    answers.camera_type = options.camera_type;
  } else if (isatty(STDIN_FILENO) != 0 && !floor) {
    const Question question{
        "--camera-type",
        "What does the camera give?",
        {{"camera3d", "points in metres: a depth camera"}, {"camera2d", "pixels"}}};
    answers.camera_type = ask(question, [](const std::string& type) -> std::string {
      return type == "camera3d" || type == "camera2d" ? "" : "camera3d or camera2d";
    });
  }
  if (!options.camera_name.empty()) answers.camera_name = options.camera_name;
}

/// Before any question: what was given must not be found wrong at the end.
void check_given_links(const Robot& robot, const InitOptions& options) {
  Diagnostics diagnostics;
  for (const auto& [option, link] :
       {std::pair("--base", options.base), std::pair("--arm", options.arm),
        std::pair("--camera", options.camera)}) {
    if (!link.empty()) check_init_link(robot, option, link, diagnostics);
  }
  diagnostics.throw_if_errors();
}

InitAnswers answer(const Robot& robot, const InitOptions& options) {
  check_given_links(robot, options);
  InitAnswers answers;
  answers.base = options.base;
  answers.arm = options.arm;
  answers.camera = options.camera;
  answer_targets(options, answers);
  if (needs_arm(answers.target) && answers.arm.empty()) {
    answers.arm = ask_link(robot, {"--arm", "Which link is at the end of the arm, with the target?",
                                   choices(propose_arms(robot))});
  }
  if (needs_camera(answers.target)) answer_camera(robot, options, answers);
  const std::string& end = needs_arm(answers.target) ? answers.arm : answers.camera;
  if (answers.base.empty() && robot.has_link(end)) answers.base = propose_base(robot, end);
  if (!needs_arm(answers.target) && !options.arm.empty()) {
    fmt::print(stderr, "warning: --arm has no part in target {}\n", to_string(answers.target));
  }
  if (!needs_camera(answers.target) && !options.camera.empty()) {
    fmt::print(stderr, "warning: --camera has no part in target {}\n", to_string(answers.target));
  }
  return answers;
}

void refuse_existing(const InitOptions& options) {
  if (options.force || !std::filesystem::exists(std::filesystem::symlink_status(options.output))) {
    return;
  }
  throw OutputError(options.output + ": exists; give --force to replace it, or another --output");
}

}  // namespace

int init(const InitOptions& options) {
  refuse_existing(options);  // before any question
  const Robot robot = read_urdf(options.urdf);
  const std::string text = initial_config(robot, answer(robot, options));
  const std::filesystem::path output = options.output;
  refuse_existing(options);  // somebody may have written it while questions were answered
  OutputFolder folder(output.has_parent_path() ? output.parent_path() : ".");
  folder.write({{output.filename().string(), text}});
  fmt::print("wrote {}\nnext: kinecal check --urdf {} --config {}\n", options.output, options.urdf,
             options.output);
  return kDone;
}

}  // namespace kinecal::cli
