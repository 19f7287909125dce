// The text of a first configuration: definitions of initial_config.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/init/initial_config.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/check_answers.ipp"
#include "kinecal/tools/init/plan_targets.ipp"

namespace kinecal {

void check_init_link(const Robot& robot, const std::string& option, const std::string& link,
                     Diagnostics& diagnostics) {
  if (link.empty()) {
    diagnostics.error({option, 0}, "no link is given");
  } else if (!robot.has_link(link)) {
    diagnostics.error({option, 0}, fmt::format("no link '{}' in robot '{}'{}", link, robot.name(),
                                               did_you_mean(link, robot.link_names())));
  }
}

void check_init_frame(const Robot& robot, const std::string& option, const std::string& name,
                      Diagnostics& diagnostics) {
  if (name.empty()) {
    diagnostics.error({option, 0}, "no frame is given");
  } else if (!is_free_frame_name(robot, name)) {
    diagnostics.error({option, 0}, "'" + name +
                                       "' is a link or a joint of the robot, or resembles one; a "
                                       "frame that the URDF does not contain needs another name");
  }
}

void check_init_camera_name(const std::string& option, const std::string& name,
                            Diagnostics& diagnostics) {
  if (name.empty() || name == "arm" || name == "board") {
    diagnostics.error({option, 0}, "'" + name + "' cannot be the camera's name; choose another");
  }
}

namespace detail {
namespace {

/// A text as comment lines of at most 100 columns.
[[nodiscard]] std::string comment_lines(std::string_view text, const std::string& indent) {
  constexpr std::size_t kWidth = 100;
  std::string lines, line = indent + "#";
  const std::size_t empty = line.size();
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t blank = std::min(text.find(' ', at), text.size());
    const std::string_view word = text.substr(at, blank - at);
    if (line.size() > empty && line.size() + 1 + word.size() > kWidth) {
      if (line.ends_with(' ')) line.pop_back();  // of two spaces between sentences
      lines += line + '\n';
      line.resize(empty);
    }
    line += ' ';
    line += word;
    at = blank + 1;
  }
  return text.empty() ? "" : lines + line + '\n';
}

/// A list of entries below its comment; empty if there are no entries.
/// @param on_a_line  write each entry in braces, on one line
[[nodiscard]] std::string list_to_yaml(const std::string& key, const std::string& why,
                                       const std::vector<InitEntry>& entries, bool on_a_line) {
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

/// Offsets that are not freed, as comments below the free ones.
[[nodiscard]] std::string left_out_comments(const InitPlan& plan) {
  std::string text;
  for (const InitLeftOut& left_out : plan.left_out) {
    text += comment_lines("Left out: " + name_to_yaml(left_out.joint) + ".  " + left_out.why + ".",
                          plan.free_params.empty() ? "" : " ");
  }
  return text.empty() || !plan.free_params.empty() ? text : "\n" + text;
}

[[nodiscard]] std::string plan_to_yaml(const Robot& robot, const InitAnswers& answers,
                                       const InitPlan& plan) {
  std::string target(to_string(answers.target, answers.board));
  if (answers.with_ground) target += " and ground";
  std::string text =
      comment_lines(fmt::format("Calibration of robot {} from {}.  'kinecal init' wrote this first "
                                "configuration: adapt it to your robot.",
                                name_to_yaml(robot.name()), target),
                    "");
  text += comment_lines(
      "Units are metres, radians and pixels.  'kinecal check' reports errors in this file, "
      "'kinecal calibrate' what the samples leave undetermined.",
      "");
  text += "\n" + comment_lines("The link in which all measurements are compared.", "");
  text += "base_link: " + name_to_yaml(answers.base) + "\nmax_num_iterations: 1000\n";
  text += list_to_yaml(
      "models",
      "What makes observations, and the link that it is fixed to.  A model's name is the "
      "sensor_name of its observations.",
      plan.models, false);
  text += list_to_yaml(
      "free_params",
      needs_camera(answers.target)
          ? "Parameters to calibrate: joint offsets, which are added to the measured positions, "
            "and the camera's parameters."
          : "Parameters to calibrate: joint offsets, which are added to the measured positions.",
      plan.free_params, false);
  text += left_out_comments(plan);
  text += list_to_yaml("free_frames",
                       "Frames to calibrate, by the names of their joints: how a part is mounted "
                       "on the one before it.  Free one rotation or all three.",
                       plan.free_frames, true);
  text += list_to_yaml("free_frames_initial_values",
                       "Where the search starts, for frames that the URDF does not contain.",
                       plan.initial_values, true);
  text +=
      list_to_yaml("error_blocks",
                   "What is compared.  A feature that is more than 3 sigma off has no more "
                   "influence than one at 3 sigma, so one bad capture does not ruin the result.",
                   plan.error_blocks, false);
  return text;
}

}  // namespace
}  // namespace detail

std::string initial_config(const Robot& robot, const InitAnswers& given) {
  const InitAnswers answers = with_proposals(robot, given);
  detail::check_answers(robot, answers);
  return detail::plan_to_yaml(robot, answers, detail::plan_initial_config(robot, answers));
}

}  // namespace kinecal
