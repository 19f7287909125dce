// kinecal init: writes a first configuration from a URDF and a few answers.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <utility>

#include "commands.hpp"
#include "kinecal/io/init/initial_config.hpp"
#include "kinecal/io/urdf/read_urdf.hpp"
#include "output_file.hpp"
#include "question.hpp"

namespace kinecal::cli {
namespace {

/// What is wrong with an answer; empty if nothing is.
/// @param check  reports it to diagnostics
template <class Check>
std::string why_not(const Check& check) {
  Diagnostics diagnostics;
  check(diagnostics);
  return diagnostics.errors.empty() ? "" : diagnostics.errors.front();
}

std::string ask_link(const Robot& robot, const Question& question) {
  return ask(question, [&](const std::string& link) {
    return why_not([&](Diagnostics& d) { check_init_link(robot, question.option, link, d); });
  });
}

std::string check_target(const std::string& word) {
  if (init_target(word)) return "";
  std::vector<std::string_view> words;
  for (const InitTargetWord& known : kInitTargets) words.push_back(known.word);
  return fmt::format("'{}' is not a target{}", word, did_you_mean(word, words));
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
    if (needs_camera(target) && target != InitTarget::ground && on_a_terminal() &&
        options.camera_type != "camera2d") {
      const Question floor{"--target", "Does the camera also see the floor, in separate samples?",
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
          fmt::format("--target: {} and {} do not go into one configuration; only ground can be "
                      "combined with another target",
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
  } else if (on_a_terminal() && !floor) {
    const Question question{
        "--camera-type",
        "What does the camera measure?",
        {{"camera3d", "points in metres: a depth camera"}, {"camera2d", "pixels"}}};
    answers.camera_type = ask(question, [](const std::string& type) -> std::string {
      return type == "camera3d" || type == "camera2d" ? "" : "camera3d or camera2d";
    });
  }
  answers.camera_name = ask_unless_given(
      options.camera_name,
      {"--robot-camera-name", "What do the samples call the camera (sensor_name)?",
       choices({answers.camera_name})},
      [](const std::string& name) {
        return why_not([&](Diagnostics& d) { check_init_camera_name("camera", name, d); });
      });
}

/// Names that have a proposal: the base, and frames that the URDF does not contain.
void answer_names(const Robot& robot, const InitOptions& options, InitAnswers& answers) {
  const InitAnswers proposed = with_proposals(robot, answers);
  const auto frame = [&](const std::string& given, const Question& question) {
    return ask_unless_given(given, question, [&](const std::string& name) {
      return why_not([&](Diagnostics& d) { check_init_frame(robot, question.option, name, d); });
    });
  };
  const bool tracker = answers.target == InitTarget::tracker;
  if (needs_target_frame(answers.target)) {
    answers.target_frame =
        frame(options.target_frame,
              {"--target-frame",
               fmt::format("What do the samples call the frame of the {} (frame_id)?",
                           tracker ? "reflector" : "board"),
               choices({proposed.target_frame})});
  }
  if (tracker) {
    answers.tracker_frame =
        frame(options.tracker_frame,
              {"--tracker-frame", "What do the samples call the frame of the tracker (frame_id)?",
               choices({proposed.tracker_frame})});
  }
  if (proposed.base.empty()) return;  // a link does not exist; initial_config() reports it
  const bool floor = answers.with_ground || answers.target == InitTarget::ground;
  answers.base = ask_unless_given(
      options.base,
      {"--base",
       fmt::format("In which link are measurements compared{}?",
                   floor ? " (z = 0 is the floor)" : ""),
       choices({proposed.base})},
      [&](const std::string& link) {
        return why_not([&](Diagnostics& d) { check_init_link(robot, "--base", link, d); });
      });
}

/// Checks the options before any question, so that no answers are lost.
void check_given(const Robot& robot, const InitOptions& options) {
  Diagnostics diagnostics;
  for (const auto& [option, link] :
       {std::pair("--base", options.base), std::pair("--arm", options.arm),
        std::pair("--camera", options.camera)}) {
    if (!link.empty()) check_init_link(robot, option, link, diagnostics);
  }
  for (const auto& [option, frame] : {std::pair("--target-frame", options.target_frame),
                                      std::pair("--tracker-frame", options.tracker_frame)}) {
    if (!frame.empty()) check_init_frame(robot, option, frame, diagnostics);
  }
  diagnostics.throw_if_errors();
}

/// Warns of options that the target does not use.
void warn_of_idle(const InitOptions& options, InitTarget target) {
  const auto warn = [&](bool is_used, const std::string& given, const char* option) {
    if (is_used || given.empty()) return;
    fmt::print(stderr, "warning: {} is not used with target {}\n", option, to_string(target));
  };
  warn(needs_arm(target), options.arm, "--arm");
  warn(needs_camera(target), options.camera, "--camera");
  warn(needs_camera(target), options.camera_type, "--camera-type");
  warn(needs_camera(target), options.camera_name, "--robot-camera-name");
  warn(needs_target_frame(target), options.target_frame, "--target-frame");
  warn(target == InitTarget::tracker, options.tracker_frame, "--tracker-frame");
}

InitAnswers answer(const Robot& robot, const InitOptions& options) {
  check_given(robot, options);
  InitAnswers answers;
  answers.base = options.base;
  answers.arm = options.arm;
  answers.camera = options.camera;
  answer_targets(options, answers);
  warn_of_idle(options, answers.target);
  if (needs_arm(answers.target) && answers.arm.empty()) {
    answers.arm = ask_link(robot, {"--arm", "Which link is at the end of the arm, with the target?",
                                   choices(propose_arms(robot))});
  }
  if (needs_camera(answers.target)) answer_camera(robot, options, answers);
  answer_names(robot, options, answers);
  return answers;
}

/// Quoted, if a shell would not take the text as one word.
std::string as_word(const std::string& text) {
  const bool is_plain = text.find_first_of(" \t\"$&;()<>|*?'") == std::string::npos;
  return is_plain ? text : "'" + text + "'";
}

}  // namespace

int init(const InitOptions& options) {
  const auto check = [&] { check_output(options.output, {options.urdf}, options.force); };
  check();  // before any question
  const Robot robot = read_urdf(options.urdf);
  const std::string text = initial_config(robot, answer(robot, options));
  check();  // the file may have appeared meanwhile
  write_file(options.output, text);
  fmt::print("wrote {}\nnext: kinecal check --urdf {} --config {}\n", options.output,
             as_word(options.urdf), as_word(options.output));
  return kDone;
}

}  // namespace kinecal::cli
