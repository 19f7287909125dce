// kinecal init: writes a first configuration from a URDF and a few answers.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <utility>

#include "commands.hpp"
#include "input.hpp"
#include "kinecal/config/read_config.hpp"
#include "kinecal/files/csv/read_csv_samples.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/results/standard_output.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/joined_urdf.hpp"
#include "kinecal/files/urdf/patch_urdf.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/text/name_list.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/answers_from_samples.hpp"
#include "kinecal/tools/init/initial_capture.hpp"
#include "kinecal/tools/init/initial_config.hpp"
#include "kinecal/tools/init/possible_targets.hpp"
#include "kinecal/tools/init/proposed_columns.hpp"
#include "kinecal/tools/init/several_answers.hpp"
#include "output_file.hpp"
#include "question.hpp"
#include "report.hpp"
#include "terminal.hpp"

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

/// The links of a list with commas; a link whose name has commas is one.
std::vector<std::string> links_of(const Robot& robot, const std::string& list) {
  if (robot.has_link(list)) return {list};
  return names_of_list(list);
}

/// The first of them; empty of an empty list.
std::string first_of(const Robot& robot, const std::string& list) {
  const std::vector<std::string> links = links_of(robot, list);
  return links.empty() ? "" : links.front();
}

/// One link, or several with commas.
std::string ask_links(const Robot& robot, const Question& question) {
  return ask(question, [&](const std::string& links) {
    return why_not([&](Diagnostics& d) {
      for (const std::string& link : links_of(robot, links))
        check_init_link(robot, question.option, link, d);
    });
  });
}

/// That a target goes into no configuration with others, and what to do.
std::string alone_text(std::string_view target) {
  return fmt::format(
      "{0} does not go into one configuration with others; call init for {0} "
      "alone, with another --output",
      target);
}

/// Why a word is not a target of this robot; empty if it is.
std::string check_target(const Robot& robot, const InitOptions& options, const std::string& word) {
  if (word == kBaseTarget || word == kMagnetometerTarget) return alone_text(word);
  if (const auto target = init_target(word)) {
    return why_no_target(robot, target->target, first_of(robot, options.arm),
                         first_of(robot, options.camera));
  }
  std::vector<std::string_view> words;
  for (const InitTargetWord& known : kInitTargets) words.push_back(known.word);
  words.insert(words.end(), {kBaseTarget, kMagnetometerTarget});
  return fmt::format("'{}' is not a target{}; choose one of {}", word, did_you_mean(word, words),
                     init_target_words());
}

/// Asks for the targets that this robot can have.
void ask_targets(const Robot& robot, InitOptions& options) {
  std::vector<std::string>& words = options.targets;
  const bool has_camera = !options.camera.empty() || !propose_cameras(robot).empty();
  Question question{"--target", "What is the robot measured against?", {}};
  for (const InitTargetWord& known : kInitTargets) {
    const std::string word(known.word);
    if (!check_target(robot, options, word).empty()) continue;
    question.choices.push_back({word, std::string(known.says)});
  }
  question.choices.push_back(
      {std::string(kBaseTarget), "a mobile base: what it reports of its motion"});
  if (!has_camera) say("No link of the URDF looks like a camera.\n");
  words = {ask(question, [&](const std::string& word) {
    return word == kBaseTarget ? "" : check_target(robot, options, word);
  })};
  if (words.front() == kBaseTarget) return;
  const InitTarget target = init_target(words.front())->target;
  if (!needs_camera(target) || target == InitTarget::ground || !on_a_terminal() ||
      options.camera_type == "camera2d") {
    return;
  }
  const Question floor{"--target", "Does the camera also see the floor, in separate samples?",
                       choices({"no", "yes"})};
  const std::string seen = ask(floor, [](const std::string& word) -> std::string {
    return word == "no" || word == "yes" ? "" : "yes or no";
  });
  if (seen == "yes") words.push_back("ground");
}

/// One or two targets: the floor may come with another one.
void answer_targets(const Robot& robot, InitOptions& options, InitAnswers& answers) {
  if (options.targets.empty()) ask_targets(robot, options);
  const std::vector<std::string>& words = options.targets;
  bool is_chosen = false;
  for (const std::string& word : words) {
    const auto known = init_target(word);
    if (!known) throw InputError("--target: " + check_target(robot, options, word));
    if (known->target == InitTarget::ground) {
      answers.with_ground = true;
    } else if (is_chosen && (known->target != answers.target || known->board != answers.board)) {
      throw InputError(
          fmt::format("--target: {} and {} do not go into one configuration; only ground can be "
                      "combined with another target",
                      to_string(answers.target, answers.board), word));
    } else {
      answers.target = known->target;
      answers.board = known->board;
      is_chosen = true;
    }
  }
  if (!is_chosen) {
    answers.target = InitTarget::ground;
    answers.with_ground = false;
  }
  // Before further questions, so that no answers are lost.
  const bool is_one =
      links_of(robot, options.arm).size() * links_of(robot, options.camera).size() < 2;
  const std::string why = why_no_target(robot, answers.target, options.arm, options.camera);
  if (is_one && !why.empty()) throw InputError(why);
}

void answer_camera(const Robot& robot, InitOptions& options, InitAnswers& answers) {
  if (answers.camera.empty()) {
    options.camera = ask_links(
        robot, {"--camera",
                "Which link is the camera's optical frame (z ahead, y down; several: with commas)?",
                choices(cameras_for(robot, answers.target, answers.arm))});
    answers.camera = first_of(robot, options.camera);
  }
  const bool floor = answers.with_ground || answers.target == InitTarget::ground;
  if (options.camera_type.empty() && on_a_terminal() && !floor) {
    const Question question{
        "--camera-type",
        "What does the camera measure?",
        {{"camera3d", "points in metres: a depth camera"}, {"camera2d", "pixels"}}};
    options.camera_type = ask(question, [](const std::string& type) -> std::string {
      return type == "camera3d" || type == "camera2d" ? "" : "camera3d or camera2d";
    });
  }
  if (!options.camera_type.empty()) answers.camera_type = options.camera_type;
  if (links_of(robot, options.camera).size() > 1) {  // they have the names of their links
    if (options.camera_name.empty()) return;
    throw InputError("--robot-camera-name is of one camera; several have the names of their links");
  }
  answers.camera_name = options.camera_name = ask_unless_given(
      options.camera_name,
      {"--robot-camera-name", "What do the samples call the camera (sensor_name)?",
       choices({answers.camera_name})},
      [](const std::string& name) {
        return why_not([&](Diagnostics& d) { check_init_camera_name("camera", name, d); });
      });
}

/// The names of a list as somebody types it: blanks after commas are none of a name.
std::vector<std::string> typed_names(const std::string& list) {
  std::vector<std::string> names = names_of_list(list);
  for (std::string& name : names) {
    name.erase(0, name.find_first_not_of(' '));
    name.erase(name.find_last_not_of(' ') + 1);
  }
  std::erase(names, "");
  return names;
}

/// The frame of a board, or those of one or several reflectors.
void set_target_frames(const std::string& given, InitAnswers& answers) {
  std::vector<std::string> names = typed_names(given);
  if (names.empty()) return;
  answers.target_frame = names.front();
  answers.more_reflectors.assign(names.begin() + 1, names.end());
}

/// The other hand that holds the same thing.
void answer_other_hand(const Robot& robot, InitOptions& options, InitAnswers& answers) {
  const std::string proposed = with_proposals(robot, answers).carrier;
  std::vector<std::string> hands = propose_arms(robot);
  std::erase(hands, answers.arm);
  if (!proposed.empty()) hands = {proposed};
  if (!options.touched_link.empty()) return;
  answers.carrier = options.touched_link = ask(
      {"--touched-link", "Which link is the other hand, which holds the same thing?",
       choices(hands)},
      [&](const std::string& link) {
        return why_not([&](Diagnostics& d) { check_init_link(robot, "--touched-link", link, d); });
      });
}

/// Names that have a proposal: the base, and frames that the URDF does not contain.
void answer_names(const Robot& robot, InitOptions& options, InitAnswers& answers) {
  const InitAnswers proposed = with_proposals(robot, answers);
  const auto frame = [&](const std::string& given, const Question& question) {
    return ask_unless_given(given, question, [&](const std::string& names) {
      return why_not([&](Diagnostics& d) {
        for (const std::string& name : typed_names(names)) {
          if (is_touched(answers.target) && robot.has_link(name)) continue;
          check_init_frame(robot, question.option, name, d);
        }
      });
    });
  };
  const bool tracker = answers.target == InitTarget::tracker;
  const bool is_one = links_of(robot, options.arm).size() < 2;
  if (!is_one && !options.target_frame.empty()) {
    throw InputError("--target-frame is of one arm; those of several are LINK_" +
                     proposed.target_frame);
  }
  if (is_one && needs_target_frame(answers.target)) {
    options.target_frame =
        frame(options.target_frame,
              {"--target-frame",
               fmt::format("What do the samples call the frame of the {} (frame_id{})?",
                           tracker                      ? "reflector"
                           : is_touched(answers.target) ? "tip"
                                                        : "board",
                           tracker ? "; several: with commas" : ""),
               choices({proposed.target_frame})});
    set_target_frames(options.target_frame, answers);
  }
  if (tracker) {
    answers.tracker_frame = options.tracker_frame =
        frame(options.tracker_frame,
              {"--tracker-frame", "What do the samples call the frame of the tracker (frame_id)?",
               choices({proposed.tracker_frame})});
  }
  if (proposed.base.empty()) return;  // a link does not exist; initial_config() reports it
  const bool floor = answers.with_ground || answers.target == InitTarget::ground;
  answers.base = options.base = ask_unless_given(
      options.base,
      {"--base",
       fmt::format("In which link are measurements compared{}?",
                   floor ? " (z = 0 is the floor)" : ""),
       choices({proposed.base})},
      [&](const std::string& link) {
        return why_not([&](Diagnostics& d) { check_init_link(robot, "--base", link, d); });
      });
}

/// The place of --touched-at, metres.
std::optional<Vector3<double>> touched_at(const InitOptions& options) {
  const std::vector<double>& at = options.touched_at;
  if (at.empty()) return std::nullopt;
  return Vector3<double>(at.at(0), at.at(1), at.at(2));
}

/// Checks the options before any question, so that no answers are lost.
void check_given(const Robot& robot, const InitOptions& options) {
  Diagnostics diagnostics;
  if (!options.base.empty()) check_init_link(robot, "--base", options.base, diagnostics);
  for (const std::string& word : options.targets) {
    const auto target = init_target(word);
    if (target && options.length) check_init_length(target->target, *options.length, diagnostics);
    if (target && !options.touched_at.empty())
      check_init_place(target->target, *touched_at(options), diagnostics);
  }
  if (!options.touched_link.empty()) {
    check_init_link(robot, "--touched-link", options.touched_link, diagnostics);
  }
  for (const auto& [option, links] :
       {std::pair("--arm", options.arm), std::pair("--camera", options.camera)}) {
    for (const std::string& link : links_of(robot, links))
      check_init_link(robot, option, link, diagnostics);
  }
  for (const std::string& frame : typed_names(options.target_frame)) {
    if (robot.has_link(frame)) continue;  // may be a tip; else initial_config() reports it
    check_init_frame(robot, "--target-frame", frame, diagnostics);
  }
  if (!options.tracker_frame.empty()) {
    check_init_frame(robot, "--tracker-frame", options.tracker_frame, diagnostics);
  }
  diagnostics.throw_if_errors();
}

/// Warns of options that the target does not use.
void warn_of_idle(const InitOptions& options, InitTarget target, std::string_view word) {
  const auto warn = [&](bool is_used, const std::string& given, const char* option) {
    if (is_used || given.empty()) return;
    say(stderr, "warning: {} is not used with target {}\n", option, word);
  };
  warn(needs_arm(target) || target == InitTarget::robot, options.arm, "--arm");
  warn(needs_camera(target), options.camera, "--camera");
  warn(needs_camera(target), options.camera_type, "--camera-type");
  warn(needs_camera(target), options.camera_name, "--robot-camera-name");
  warn(needs_target_frame(target), options.target_frame, "--target-frame");
  warn(target == InitTarget::tracker, options.tracker_frame, "--tracker-frame");
  warn(has_length(target), options.length ? "given" : "", "--length");
  warn(is_touched(target) && target != InitTarget::gravity, options.touched_link, "--touched-link");
  warn(has_place(target), options.touched_at.empty() ? "" : "given", "--touched-at");
}

/// A file beside the configuration.
std::string beside_output(const InitOptions& options, const char* name) {
  return (std::filesystem::path(options.output).parent_path() / name).string();
}

/// The columns.yaml of a table that samples come from; empty if they come from no table.
std::string columns_file(const InitOptions& options) {
  if (options.from.size() != 1) return "";
  const std::string extension = std::filesystem::path(options.from.front()).extension().string();
  const bool is_table = extension == ".csv" || extension == ".tsv" || extension == ".txt";
  if (!is_table) return "";
  return beside_output(options, "columns.yaml");
}

/// The target given as an option, without the floor; nullopt if none is.
/// @throws InputError  "--target: ..."
std::optional<InitTarget> given_target(const Robot& robot, const InitOptions& options) {
  std::optional<InitTarget> target;
  for (const std::string& word : options.targets) {
    const auto known = init_target(word);
    if (!known) throw InputError("--target: " + check_target(robot, options, word));
    if (!target || *target == InitTarget::ground) target = known->target;
  }
  return target;
}

/// The table with the places of sockets beside a columns.yaml: one that is there, or that of two sockets whose distance is
/// given.
/// @returns  its name; empty: the places are not known
std::string sockets_file(const InitOptions& options, const std::string& columns,
                         const std::string& table) {
  const std::string name = "sockets.csv";
  const std::string path = (std::filesystem::path(columns).parent_path() / name).string();
  const bool is_there = std::filesystem::exists(path);
  if (is_there && !(options.length && options.force)) {
    say("{} is there and is used\n", path);
    return name;
  }
  if (!options.length) return "";
  write_output(path, sockets_at_distance(detail::read_text_file(table), table, *options.length));
  say("wrote {}\n", path);
  return name;
}

/// @param text  of a columns.yaml that is there
/// @throws InputError  if 'init' wrote it for another target than is asked for now
void check_target_of_columns(const std::string& file, const std::string& text,
                             std::optional<InitTarget> target) {
  const std::optional<InitTarget> before = target_of_columns(text);
  if (!target || !before || *before == *target) return;
  throw InputError(fmt::format(
      "{}: an earlier 'kinecal init' wrote it for target {}, and --target is {}; --force writes it "
      "anew",
      file, to_string(*before), to_string(*target)));
}

/// The samples of --from.  Of a table, the meaning of its columns is proposed, unless a columns.yaml is there.
std::vector<Sample> read_from(const Robot& robot, const InitOptions& options) {
  Diagnostics diagnostics;
  const std::string columns = columns_file(options);
  if (columns.empty()) {
    Recording recording = read_recordings(options.from, diagnostics);
    print_or_throw(diagnostics);
    return std::move(recording.samples);
  }
  const std::string& table = options.from.front();
  const bool is_there = std::filesystem::exists(columns);
  const std::optional<InitTarget> target = given_target(robot, options);
  const std::string known = is_there ? detail::read_text_file(columns) : "";
  const bool is_ours = known.starts_with(kProposedColumnsMark);
  if (is_there && (!options.force || !is_ours)) {
    check_target_of_columns(columns, known, target);
    say("{} is there and is used\n", columns);
  } else {
    const bool has_sockets = target ? *target == InitTarget::sockets : options.length.has_value();
    const bool is_grip = target == InitTarget::grip;
    const std::string sockets = has_sockets ? sockets_file(options, columns, table) : "";
    write_output(columns, proposed_columns(robot, detail::read_text_file(table), table, target,
                                           sockets, is_grip ? options.arm : options.target_frame));
    say("wrote {}\n  what each column of {} means, as far as names and values tell: look at it\n",
        columns, table);
  }
  std::vector<Sample> samples = read_csv_samples(table, columns, diagnostics);
  print_or_throw(diagnostics);
  return samples;
}

/// What samples say of a camera and what it sees, or of a tracker.
std::string answers_text(const InitOptions& options, const InitAnswers& found) {
  std::string text = fmt::format("from the samples: target {}", to_string(found.target));
  if (found.with_ground) text += ",ground";
  if (needs_arm(found.target)) text += fmt::format("; arm {}", found.arm);
  if (needs_camera(found.target)) {
    text += fmt::format("; camera {} ('{}', {})", found.camera, found.camera_name,
                        found.camera_type == "camera2d" ? "pixels" : "points");
  }
  if (!found.target_frame.empty()) text += fmt::format("; frame '{}'", found.target_frame);
  if (options.base.empty() && !found.base.empty()) {
    text += fmt::format("; base {}: joints before it are not in the samples", found.base);
  }
  return text;
}

/// The answers that samples give, without questions; prints them.
std::vector<InitAnswers> answer_from_samples(const Robot& robot, const InitOptions& options) {
  check_given(robot, options);
  const std::vector<Sample> samples = read_from(robot, options);
  const auto is_drive = [](const Sample& sample) {
    return sample.observations.empty() && sample.joint_names.empty() && !sample.conditions.empty();
  };
  if (!samples.empty() && std::all_of(samples.begin(), samples.end(), is_drive)) {
    throw InputError("--from: these samples are of the drive of a base; give --target base");
  }
  InitAnswers given;
  given.base = options.base;
  given.arm = options.arm;
  given.camera = options.camera;
  given.tracker_frame = options.tracker_frame;
  set_target_frames(options.target_frame, given);
  given.length = options.length;
  given.carrier = options.touched_link;
  given.at = touched_at(options);
  const std::optional<InitTarget> target = given_target(robot, options);
  if (target) given.target = *target;
  std::vector<InitAnswers> all = all_answers_from_samples(robot, samples, given);
  for (const InitAnswers& found : all) {
    if (target && *target != found.target) {
      throw InputError(fmt::format("--target: the samples of --from are those of {}, not of {}",
                                   to_string(found.target), options.targets.front()));
    }
    say("{}\n", answers_text(options, found));
  }
  return all;
}

/// @param options  receives the answers, so that they can be given as options
std::vector<InitAnswers> answer(const Robot& robot, InitOptions& options) {
  check_given(robot, options);
  InitAnswers answers;
  answers.base = options.base;
  answers.arm = first_of(robot, options.arm);
  answers.camera = first_of(robot, options.camera);
  answers.length = options.length;
  answers.carrier = options.touched_link;
  answers.at = touched_at(options);
  answer_targets(robot, options, answers);
  warn_of_idle(options, answers.target, to_string(answers.target, answers.board));
  if (needs_arm(answers.target) && answers.arm.empty()) {
    options.arm = ask_links(
        robot, {"--arm",
                "Which link is at the end of the arm, with the target (several arms: with commas)?",
                choices(propose_arms(robot))});
    answers.arm = first_of(robot, options.arm);
  }
  if (answers.target == InitTarget::grip) answer_other_hand(robot, options, answers);
  if (needs_camera(answers.target)) answer_camera(robot, options, answers);
  answer_names(robot, options, answers);
  return answers_of_all(
      robot, answers,
      needs_arm(answers.target) || answers.target == InitTarget::robot
          ? links_of(robot, options.arm)
          : std::vector<std::string>(),
      needs_camera(answers.target) ? links_of(robot, options.camera) : std::vector<std::string>());
}

/// The call with all that was given and answered.
std::string call_of(const InitOptions& options) {
  ShellCommand call{"kinecal", "init"};
  std::string targets;
  for (const std::string& target : options.targets) {
    targets += (targets.empty() ? "" : ",") + target;
  }
  for (const std::string& urdf : options.urdfs) call.add_option("--urdf", {urdf});
  for (const std::string& stand : options.stands) call.add_option("--stands", {stand});
  for (const auto& [option, value] :
       {std::pair("--target", targets), std::pair("--arm", options.arm),
        std::pair("--camera", options.camera), std::pair("--camera-type", options.camera_type),
        std::pair("--robot-camera-name", options.camera_name),
        std::pair("--target-frame", options.target_frame),
        std::pair("--tracker-frame", options.tracker_frame),
        std::pair("--touched-link", options.touched_link),
        std::pair("--touched-at", fmt::format("{}", fmt::join(options.touched_at, ","))),
        std::pair("--length", options.length ? fmt::format("{}", *options.length) : ""),
        std::pair("--base", options.base)}) {
    if (!value.empty()) call.add_option(option, {value});
  }
  return call.str();
}

/// The answers; after questions, an error comes with the call that gives them.
struct Configured {
  std::vector<InitAnswers> answers;  ///< of each camera and arm
  std::string text;                  ///< of the configuration
};
/// @param stands  joints on which several robots stand
/// @param given   before questions
Configured configure(const Robot& robot, const std::vector<std::string>& stands,
                     const InitOptions& given, InitOptions options) {
  try {
    Configured all{
        options.from.empty() ? answer(robot, options) : answer_from_samples(robot, options), ""};
    relate_stands(robot, stands, all.answers);
    all.text = initial_config(robot, all.answers);
    return all;
  } catch (const InputError& error) {
    const std::string call = call_of(options);
    if (!on_a_terminal() || call == call_of(given)) throw;
    throw InputError(std::string(error.what()) + "\nto keep your answers: " + call);
  }
}

/// The capture.yaml beside the configuration, unless it is given.
std::string capture_file(const InitOptions& options) {
  return options.capture.empty() ? beside_output(options, "capture.yaml") : options.capture;
}

/// Whether a file is one that a session or somebody has written; not init.
bool is_of_others(const std::string& path) {
  if (!std::filesystem::exists(path)) return false;
  return !detail::read_text_file(path).starts_with(kInitialCaptureMark);
}

/// Writes the capture.yaml that goes with a configuration; keeps one that init has not written.
void write_capture(const Robot& robot, const std::vector<InitAnswers>& answers,
                   const InitOptions& options) {
  const std::string text = initial_capture(robot, answers), file = capture_file(options);
  if (text.empty()) return;
  const bool is_asked_for = !options.capture.empty() && options.force;
  if (!is_asked_for && (is_of_others(file) || (std::filesystem::exists(file) && !options.force))) {
    say("note: {} is there and is kept; with this configuration, it needs\n  {}\n", file,
        capture_names(robot, answers.front()));
    return;
  }
  write_output(file, text);
  say("wrote {}\n  fill in what is zero: its sizes decide the scale of the result\n", file);
}

/// Where 'kinecal calibrate' will write the zeros of the joints that a configuration frees; empty if
/// it frees none.
std::string joint_zeros_text(const Robot& robot, const std::string& urdf_text,
                             const std::string& config, const InitOptions& options) {
  Diagnostics reported_by_check;
  const Config written =
      parse_config(config, options.output, reported_by_check, NothingFree::is_allowed);
  std::vector<JointPatch> patches;
  for (const StepConfig& step : written.steps) {
    for (const FreeParamConfig& free : step.free_params) {
      if (robot.has_joint(free.name)) patches.push_back({free.name, 1.0, {}});
    }
  }
  if (patches.empty()) return "";
  const OffsetPlaces places = offset_places(urdf_text, options.urdf, robot, patches);
  const std::string_view param = "<param name=\"offset\"> of <ros2_control>";
  if (places.rising.empty()) return fmt::format("joint zeros: calibrate adds them to {}\n", param);
  std::string text = "joint zeros: calibrate writes ";
  if (places.ros2_control.empty()) text += "them ";
  if (!places.ros2_control.empty()) {
    text +=
        fmt::format("those of {} into {}, others ", fmt::join(places.ros2_control, ", "), param);
  }
  text += "into <calibration rising>, which ";
  return text + (places.has_calibration
                     ? "this URDF has already\n"
                     : "robot_state_publisher, MoveIt and the UR driver do not read; "
                       "'calibrate --offsets origin' moves the joints' origins instead\n");
}

/// NAME=FILE of a robot; the name is empty of a file alone.
std::pair<std::string, std::string> named_urdf(const std::string& option) {
  const std::size_t equals = option.find('=');
  if (equals == std::string::npos || std::filesystem::exists(option)) return {"", option};
  return {option.substr(0, equals), option.substr(equals + 1)};
}

/// Where a robot stands, of NAME=X,Y,Z,ROLL,PITCH,YAW.
/// @throws InputError  if it is not that, or there is no such robot
void set_stand(const std::string& option, std::vector<RobotPart>& robots) {
  const std::size_t equals = std::min(option.find('='), option.size());
  const std::string name = option.substr(0, equals);
  const auto robot = std::find_if(robots.begin(), robots.end(),
                                  [&](const RobotPart& one) { return one.name == name; });
  if (robot == robots.end()) {
    std::vector<std::string> names;
    for (const RobotPart& one : robots) names.push_back(one.name);
    throw InputError(
        fmt::format("--stands: no robot '{}'{}; --urdf names {}", name, did_you_mean(name, names),
                    names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "))));
  }
  std::vector<double> numbers;
  for (const std::string& word : typed_names(option.substr(std::min(equals + 1, option.size())))) {
    std::istringstream in(word);
    double number = 0.0;
    if (in >> number && in.eof() && std::isfinite(number)) numbers.push_back(number);
  }
  if (numbers.size() != 6) {
    throw InputError(fmt::format(
        "--stands: '{}' is not NAME=X,Y,Z,ROLL,PITCH,YAW: six numbers, metres and radians",
        option));
  }
  robot->xyz = {numbers[0], numbers[1], numbers[2]};
  robot->rpy = {numbers[3], numbers[4], numbers[5]};
}

/// The robots of --urdf if there are several.
/// @throws InputError  if they have no names
std::vector<RobotPart> several_robots(const InitOptions& options) {
  std::vector<RobotPart> robots;
  if (options.urdfs.size() == 1 && named_urdf(options.urdfs.front()).first.empty()) {
    if (!options.stands.empty()) set_stand(options.stands.front(), robots);
    return robots;
  }
  const std::filesystem::path folder = folder_of(options.output);
  for (const std::string& option : options.urdfs) {
    const auto [name, file] = named_urdf(option);
    if (name.empty() || options.urdfs.size() == 1) {
      throw InputError(fmt::format(
          "--urdf: '{}': several robots have a name each: --urdf left=FILE --urdf right=FILE",
          option));
    }
    const std::filesystem::path own =
        std::filesystem::path(folder_of(file)).lexically_proximate(folder);
    robots.push_back({name, read_urdf_text(file), file, own == "." ? "" : own.string()});
  }
  for (const std::string& stand : options.stands) set_stand(stand, robots);
  return robots;
}

/// The joints on which the robots of a URDF stand, if it was joined of several.
std::vector<std::string> stands_of(const std::string& urdf_text, const std::string& urdf) {
  std::vector<std::string> stands;
  for (const std::string& robot : joined_robots(urdf_text, urdf))
    stands.push_back(stand_joint(robot));
  return stands;
}

/// An option and whether it is given.
using GivenOption = std::pair<const char*, bool>;

/// The options of a mobile base.
std::vector<GivenOption> base_options(const InitOptions& given) {
  return {{"--drive", !given.drive.empty()},
          {"--seen", !given.seen.empty()},
          {"--sensor", !given.sensor.empty()},
          {"--wheel-radius", given.wheel_radius.has_value()},
          {"--track-width", given.track_width.has_value()},
          {"--wheelbase", given.wheelbase.has_value()},
          {"--gyro-scale", given.gyro_scale.has_value()}};
}

/// The options of arms and cameras, which neither a base nor a magnetometer has.
std::vector<GivenOption> arm_options(const InitOptions& given) {
  return {{"--arm", !given.arm.empty()},
          {"--camera", !given.camera.empty()},
          {"--cameras", !given.cameras.empty()},
          {"--camera-type", !given.camera_type.empty()},
          {"--robot-camera-name", !given.camera_name.empty()},
          {"--target-frame", !given.target_frame.empty()},
          {"--tracker-frame", !given.tracker_frame.empty()},
          {"--length", given.length.has_value()},
          {"--touched-link", !given.touched_link.empty()},
          {"--touched-at", !given.touched_at.empty()},
          {"--capture", !given.capture.empty()},
          {"--poses", !given.poses.empty()},
          {"--form", !given.form.empty()},
          {"--inverse", given.inverse},
          {"--corners", !given.corners.empty()},
          {"--target-points", !given.target_points.empty()},
          {"--stands", !given.stands.empty()}};
}

/// The target of --target that goes into no configuration with others; empty if they all are of an arm.
/// @throws InputError  if there are others, or options that it does not have
std::string_view lone_target(const InitOptions& given) {
  const std::vector<std::string>& words = given.targets;
  for (const std::string_view target : {kBaseTarget, kMagnetometerTarget}) {
    if (std::find(words.begin(), words.end(), target) == words.end()) continue;
    if (words.size() > 1) throw InputError("--target: " + alone_text(target));
    std::vector<GivenOption> foreign = arm_options(given);
    if (target != kBaseTarget) {
      const std::vector<GivenOption> of_base = base_options(given);
      foreign.insert(foreign.end(), of_base.begin(), of_base.end());
    }
    for (const auto& [option, is_given] : foreign) {
      if (is_given)
        throw InputError(fmt::format("{} does not go with --target {}", option, target));
    }
    return target;
  }
  return {};
}

}  // namespace

int init(const InitOptions& given) {
  const std::string_view lone = lone_target(given);
  if (lone == kMagnetometerTarget) return init_magnetometer(given);
  if (lone == kBaseTarget) return init_base(given);
  for (const auto& [option, is_given] : base_options(given)) {
    if (is_given) throw InputError(fmt::format("{} goes with --target base", option));
  }
  if (!given.poses.empty()) return init_hand_eye(given);
  if (!given.cameras.empty()) return init_cameras(given);
  if (!given.corners.empty()) throw InputError("--corners goes with --poses or --cameras");
  if (given.urdfs.empty()) {
    throw InputError(
        "give the robot: --urdf; or the poses of its flange: --poses; or the names of cameras "
        "alone: "
        "--cameras");
  }
  InitOptions options = given;
  const std::vector<RobotPart> robots = several_robots(given);
  options.urdf = robots.empty() ? given.urdfs.front() : beside_output(options, "robots.urdf");
  std::vector<std::string> urdfs = {options.urdf};
  for (const RobotPart& robot : robots) urdfs.push_back(robot.file);
  const auto check = [&] {
    check_output(options.output, urdfs, options.force);
    if (robots.empty()) return;
    check_output(options.urdf, {urdfs.begin() + 1, urdfs.end()}, options.force);
  };
  check();  // before any question
  if (!options.capture.empty()) {
    check_output(options.capture, {options.urdf, options.output}, options.force);
  }
  const std::string urdf_text = robots.empty() ? read_urdf_text(options.urdf) : joined_urdf(robots);
  const Robot robot = parse_urdf(urdf_text, options.urdf);
  const InitOptions before = options;
  if (options.from.empty() && options.targets.empty()) {
    check_given(robot, options);
    ask_targets(robot, options);
    if (lone_target(options) == kBaseTarget) return init_base(options);
  }
  const Configured made = configure(robot, stands_of(urdf_text, options.urdf), before, options);
  check();  // the file may have appeared meanwhile
  const InitAnswers& answers = made.answers.front();
  if (!robots.empty()) {
    write_output(options.urdf, urdf_text);
    const auto moving = std::find_if(robot.joints().begin(), robot.joints().end(),
                                     [](const Joint& joint) { return moves(joint.type); });
    say("wrote {}: the robots in link '{}'; joints are called as there, in samples, too{}\n",
        options.urdf, kWorldLink, moving == robot.joints().end() ? "" : ": " + moving->name);
  }
  write_output(options.output, made.text);
  if (made.text.find("sigma: ") != std::string::npos) {
    say("note: each sigma in {} is a guess of a residual, errors of the robot included; replace "
        "it\n  by the noise that kinecal calibrate reports, or remove it\n",
        options.output);
  }
  say("wrote {}\n", options.output);
  if (made.answers.size() > 1) say("  {}\n", pairs_text(made.answers));
  if (options.from.empty()) {
    write_capture(robot, made.answers, options);
    note_fault_of_target(to_string(answers.target, answers.board));
  }
  say("{}", joint_zeros_text(robot, urdf_text, made.text, options));
  std::vector<std::string> named = options.from;
  named.push_back(options.urdf);
  const bool streams = std::any_of(named.begin(), named.end(), detail::is_stream);
  if (streams || is_standard_output(options.output)) return kDone;  // no command could be pasted
  InputOptions inputs{.urdf = options.urdf, .config = options.output, .samples = options.from};
  const bool has_photographs = answers.camera_type == "camera2d" && is_board(answers.target);
  if (options.from.empty() && has_photographs) {
    inputs.samples = {"samples.yaml"};
    std::vector<std::string> cameras;
    for (const InitAnswers& one : made.answers) {
      if (std::find(cameras.begin(), cameras.end(), one.camera) == cameras.end())
        cameras.push_back(one.camera);
    }
    ShellCommand detect =
        ShellCommand{"kinecal", "detect", shell_file(capture_file(options)), "--images", "images"}
            .add({"--poses", "poses.csv"});
    if (cameras.size() == 1) detect.add({"--camera", "camera.yaml"});
    for (const std::string& camera : cameras) {
      if (cameras.size() > 1) inputs.cameras.push_back(camera + "=" + camera + ".yaml");
    }
    detect.add_option("--frame", {fmt::format("{}", fmt::join(cameras, ","))})
        .add({"-o", "samples.yaml"});
    say("next: {} && {}\n", detect.str(), calibrate_command(inputs).str());
  } else if (options.from.empty()) {
    say("next: {}\n", ShellCommand{"kinecal", "check"}.add(input_options(inputs)).str());
  } else if (const std::string columns = columns_file(options); !columns.empty()) {
    inputs.samples = {"samples.yaml"};
    say("next: {} && {}\n", convert_command(options.from.front(), columns).str(),
        calibrate_command(inputs).str());
  } else {
    say("next: {}\n", calibrate_command(inputs).str());
  }
  return kDone;
}

}  // namespace kinecal::cli
