// The first configuration of a robot: its URDF and a few answers in, commented YAML out.
//
// Pure functions; who asks the questions, and where the text goes, is the program's matter.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/init/plan_targets.hpp"

namespace kinecal {

/// Reports a link that the robot does not have; an answer that is missing, too.
inline void check_init_link(const Robot& robot, const std::string& option, const std::string& link,
                            Diagnostics& diagnostics) {
  if (link.empty()) {
    diagnostics.error({option, 0}, "no link is given");
  } else if (!robot.has_link(link)) {
    diagnostics.error({option, 0}, fmt::format("no link '{}' in robot '{}'{}", link, robot.name(),
                                               did_you_mean(link, robot.link_names())));
  }
}

/// Reports a name that a frame which is in no URDF cannot have.
inline void check_init_frame(const Robot& robot, const std::string& option, const std::string& name,
                             Diagnostics& diagnostics) {
  if (name.empty()) {
    diagnostics.error({option, 0}, "no frame is given");
  } else if (!is_free_frame_name(robot, name)) {
    diagnostics.error({option, 0}, "'" + name +
                                       "' is a link or a joint of the robot, or nearly; a frame "
                                       "that is in no URDF needs another name");
  }
}

/// Reports a name that a camera cannot have beside the other models.
inline void check_init_camera_name(const std::string& option, const std::string& name,
                                   Diagnostics& diagnostics) {
  if (name.empty() || name == "arm" || name == "board") {
    diagnostics.error({option, 0}, "'" + name + "' cannot be the camera's name; choose another");
  }
}

namespace detail {

/// Words of a text as lines of comments, at most 100 columns wide.
[[nodiscard]] inline std::string comment_lines(std::string_view text, const std::string& indent) {
  constexpr std::size_t kWidth = 100;
  std::string lines, line = indent + "#";
  const std::size_t empty = line.size();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, blank - at);
    if (line.size() > empty && line.size() + 1 + word.size() > kWidth) {
      lines += line + '\n';
      line.resize(empty);
    }
    line += ' ';
    line += word;
    at = blank + 1;
  }
  return text.empty() ? "" : lines + line + '\n';
}

/// A list of entries, its comment above it; nothing where there are none.
/// @param on_a_line  each entry in braces, on a line of its own
[[nodiscard]] inline std::string list_to_yaml(const std::string& key, const std::string& why,
                                              const std::vector<InitEntry>& entries,
                                              bool on_a_line) {
  if (entries.empty()) return "";
  std::string text = "\n" + comment_lines(why, "") + key + ":\n";
  for (const InitEntry& entry : entries) {
    text += comment_lines(entry.why, " ");
    const std::string name = name_to_yaml(entry.name);
    if (entry.fields.empty()) {
      text += " - " + name + "\n";
      continue;
    }
    text += (on_a_line ? " - {name: " : " - name: ") + name;
    for (const auto& [field, value] : entry.fields) {
      text += (on_a_line ? ", " : "\n   ") + field + ": " + value;
    }
    text += on_a_line ? "}\n" : "\n";
  }
  return text;
}

/// Offsets that are not freed, as comments below those that are.
[[nodiscard]] inline std::string left_out_comments(const InitPlan& plan) {
  std::string text;
  for (const InitLeftOut& left_out : plan.left_out) {
    text += comment_lines("Left out: " + name_to_yaml(left_out.joint) + ": " + left_out.why + ".",
                          plan.free_params.empty() ? "" : " ");
  }
  return text.empty() || !plan.free_params.empty() ? text : "\n" + text;
}

[[nodiscard]] inline std::string plan_to_yaml(const Robot& robot, const InitAnswers& answers,
                                              const InitPlan& plan) {
  std::string target(to_string(answers.target));
  if (answers.with_ground) target += " and ground";
  std::string text = comment_lines(
      fmt::format("Calibration of robot {} from {}: a first configuration, made by 'kinecal init' "
                  "to be changed.",
                  name_to_yaml(robot.name()), target),
      "");
  text += comment_lines(
      "Metres, radians and pixels.  'kinecal check' tells mistakes, 'kinecal calibrate' what the "
      "samples leave open.",
      "");
  text += "\n" + comment_lines("The link in which everything is compared.", "");
  text += "base_link: " + name_to_yaml(answers.base) + "\nmax_num_iterations: 1000\n";
  text += list_to_yaml("models",
                       "What observes, and the link that it is fixed to.  A model's name is the "
                       "sensor_name of its observations.",
                       plan.models, false);
  text += list_to_yaml("free_params",
                       needs_camera(answers.target)
                           ? "What may be wrong: offsets that are added to what joints report, and "
                             "the camera's own figures."
                           : "What may be wrong: offsets that are added to what joints report.",
                       plan.free_params, false);
  text += left_out_comments(plan);
  text += list_to_yaml("free_frames",
                       "Frames that may be wrong, by their joint: how a part is fixed to the one "
                       "before it.  Free one rotation or all three.",
                       plan.free_frames, true);
  text += list_to_yaml("free_frames_initial_values",
                       "Where the search starts, for frames of which the URDF knows nothing.",
                       plan.initial_values, true);
  text += list_to_yaml("error_blocks",
                       "What is compared.  A feature that is more than 3 sigma off pulls no harder "
                       "than one at 3 sigma: one bad capture does not ruin the result.",
                       plan.error_blocks, false);
  return text;
}

/// @throws InputError  with all that is wrong with the answers by themselves
inline void check_answers(const Robot& robot, const InitAnswers& answers) {
  Diagnostics diagnostics;
  const InitTarget target = answers.target;
  check_init_link(robot, "--base", answers.base, diagnostics);
  if (needs_arm(target)) check_init_link(robot, "--arm", answers.arm, diagnostics);
  if (needs_camera(target)) {
    check_init_link(robot, "--camera", answers.camera, diagnostics);
    const std::array<std::string, 2> types = {"camera3d", "camera2d"};
    if (std::find(types.begin(), types.end(), answers.camera_type) == types.end()) {
      diagnostics.error({"--camera-type", 0},
                        fmt::format("'{}' is neither camera3d nor camera2d{}", answers.camera_type,
                                    did_you_mean(answers.camera_type, types)));
    }
    check_init_camera_name("--robot-camera-name", answers.camera_name, diagnostics);
  }
  if (needs_target_frame(target)) {
    check_init_frame(robot, "--target-frame", answers.target_frame, diagnostics);
  }
  if (target == InitTarget::tracker) {
    check_init_frame(robot, "--tracker-frame", answers.tracker_frame, diagnostics);
    if (answers.target_frame == answers.tracker_frame) {
      diagnostics.error({"--tracker-frame", 0}, "is the frame of the reflector too");
    }
  }
  const bool floor = target == InitTarget::ground || answers.with_ground;
  if (floor && target == InitTarget::tracker) {
    diagnostics.error({"--target", 0},
                      "tracker and ground share nothing; make a configuration for "
                      "each");
  } else if (floor && answers.camera_type == "camera2d") {
    diagnostics.error({"--camera-type", 0}, "the floor is seen by depth cameras only: camera3d");
  }
  diagnostics.throw_if_errors();
}

}  // namespace detail

/// What is freed and compared.
/// @param given  without them, the base and the names of frames are those of with_proposals()
/// @throws InputError  "--option: what is wrong; what to do": a link that does not exist or cannot
///                     be reached, a target that tells nothing of this robot
[[nodiscard]] inline InitPlan plan_initial_config(const Robot& robot, const InitAnswers& given) {
  const InitAnswers answers = with_proposals(robot, given);
  detail::check_answers(robot, answers);
  try {
    InitPlan plan;
    if (answers.target == InitTarget::tracker) return detail::plan_tracker(robot, answers);
    if (answers.target == InitTarget::ground) {
      plan = detail::plan_ground(robot, answers);
    } else if (answers.target == InitTarget::world_checkerboard) {
      plan = detail::plan_world_checkerboard(robot, answers);
    } else {
      plan = detail::plan_hand_eye(robot, answers);
    }
    if (answers.target == InitTarget::ground || answers.with_ground) {
      detail::add_ground(plan, answers);
    }
    return plan;
  } catch (const RobotError& e) {
    throw InputError(std::string("--base: ") + e.what());
  }
}

/// The text of a configuration, in robot_calibration's dialect of ROS 1.
/// @throws InputError  as plan_initial_config()
[[nodiscard]] inline std::string initial_config(const Robot& robot, const InitAnswers& given) {
  const InitAnswers answers = with_proposals(robot, given);
  return detail::plan_to_yaml(robot, answers, plan_initial_config(robot, answers));
}

}  // namespace kinecal
