// kinecal capture with the configuration of a mobile base: records its drive behind a bridge, and drives it if that is asked for.
// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "input.hpp"
#include "interruption.hpp"
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/errors/base_motion.hpp"
#include "kinecal/files/messages/known_definitions.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/files/recordings/base_messages.hpp"
#include "kinecal/files/recordings/convert.hpp"
#include "kinecal/files/recordings/write_recording.hpp"
#include "kinecal/files/results/file_set.hpp"
#include "kinecal/files/text_file.hpp"
#include "kinecal/files/urdf/read_urdf.hpp"
#include "kinecal/files/yaml/yaml_node.hpp"
#include "kinecal/robots/ros_base.hpp"
#include "kinecal/text/counted.hpp"
#include "kinecal/text/nearest_name.hpp"
#include "output_file.hpp"
#include "question.hpp"
#include "robot_link.hpp"
#include "terminal.hpp"

namespace kinecal::cli {
namespace {

/// The topics, with those of --topic KEY=NAME.
BaseTopics topics_of(const std::vector<std::string>& given) {
  BaseTopics topics;
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    const std::string key = text.substr(0, equals),
                      name = text.substr(std::min(equals, text.size() - 1) + 1);
    if (equals == std::string::npos || name.empty()) {
      throw InputError("--topic: '" + text + "' is not KEY=NAME");
    }
    if (key == "odom")
      topics.odom = name;
    else if (key == "scan")
      topics.scans = {name};
    else if (key == "commands")
      topics.commands = name;
    else if (key == "imu" || key == "wheels" || key == "pose")
      topics.others.push_back(name);
    else {
      const std::vector<std::string> keys = {"odom", "scan", "commands", "imu", "wheels", "pose"};
      throw InputError(fmt::format("--topic: '{}' is not a key{}", key, did_you_mean(key, keys)));
    }
  }
  std::erase(topics.others, "/robot_description");  // that of --urdf is written
  return topics;
}

/// True once somebody has pressed Enter.
bool enter_is_pressed() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0 || (input.revents & POLLIN) == 0) return false;
  std::string line;
  return static_cast<bool>(std::getline(std::cin, line));
}

/// Records until Enter, Ctrl-C, or the time of --seconds.  Without --seconds, Ctrl-C is the normal end.
void follow(RosBase& base, const CaptureOptions& options) {
  using Steady = std::chrono::steady_clock;
  const bool waits = on_a_terminal();
  if (!options.seconds) {
    say("recording: drive the base; {} ends it\n", waits ? "Enter or Ctrl-C" : "Ctrl-C");
    std::fflush(stdout);
  }
  const auto began = Steady::now();
  while (!Interruption::is_asked()) {
    base.record(std::chrono::milliseconds(50));
    if (options.seconds &&
        Steady::now() - began > std::chrono::duration<double>(*options.seconds)) {
      return;
    }
    if (!options.seconds && waits && enter_is_pressed()) return;
  }
}

/// Drives, or follows.
/// @returns  why it ended early; empty if it did not
std::string run(RosBase& base, const CaptureOptions& options) {
  if (!options.drive) {
    follow(base, options);
    return "";
  }
  BaseDriving driving;
  driving.turn *= options.velocity;
  driving.speed *= options.velocity;
  if (options.distance) driving.distance = *options.distance;
  say("driving: keep clear of the base; Ctrl-C stops it\n");
  const std::string why = drive_base(
      base, driving, [] { return Interruption::is_asked(); },
      [](const std::string& line) { say("  {}\n", line); });
  return why == "interrupted" ? "" : why;
}

/// @throws InputError  if an option is given that a base does not have
void refuse_options_of_arms(const CaptureOptions& options) {
  for (const auto& [option, is_given] :
       {std::pair("--poses", !options.poses.empty()), std::pair("--manual", options.manual),
        std::pair("--resume", options.resume), std::pair("--depth", !options.depth.empty()),
        std::pair("--joint-states", !options.joints.empty()),
        std::pair("--mesh-path", !options.mesh_paths.empty()),
        std::pair("--calibrate", !options.calibrate.empty()),
        std::pair("--until", !options.until.empty()),
        std::pair("--result", !options.result.empty()),
        std::pair("--report", !options.report.empty()),
        std::pair("--contact-sheet", !options.sheet.empty())}) {
    if (!is_given) continue;
    throw InputError(
        fmt::format("{} is of an arm, and {} has an error block of a mobile base; leave {} out",
                    option, options.config, option));
  }
}

}  // namespace

bool is_base_config(const std::string& path) {
  try {
    for (const detail::YamlNode& document :
         detail::parse_yaml(detail::read_text_file(path), path)) {
      const detail::YamlNode* blocks = document.is_map() ? document.find("error_blocks") : nullptr;
      if (blocks == nullptr) continue;
      for (const detail::YamlNode& block : blocks->items) {
        const detail::YamlNode* type = block.is_map() ? block.find("type") : nullptr;
        if (type != nullptr && is_base_type(type->text)) return true;
      }
    }
  } catch (const InputError&) {  // reported where it is read
  }
  return false;
}

int capture_base(const CaptureOptions& options) {
  refuse_options_of_arms(options);
  const auto encoding = output_encoding(options.output);
  if (!encoding) {
    throw InputError("--output: a drive is recorded in a bag: " + options.output +
                     " ends neither in .bag nor in .mcap");
  }
  if (!options.robot.starts_with("ws://")) {
    throw InputError("--robot: a base is behind a bridge: ws://HOST:PORT");
  }
  if (options.distance && !(*options.distance > 0.0)) {
    throw InputError("--distance: is not positive");
  }
  check_output(options.output, {options.config, options.urdf}, options.force);
  const std::string urdf = urdf_of(options.urdf, options.robot);
  (void)parse_urdf(urdf, urdf_name(options.urdf));
  BagOutput bag(options.output, *encoding);
  write_urdf(bag, urdf);
  const auto write = [&](const std::string& topic, const std::string& type, std::int64_t time,
                         const MessageFields& message) {
    if (!detail::known_definition(type, *encoding).empty()) bag.write({topic, type}, time, message);
  };
  const Interruption interruption;
  std::string lost;
  RosBase base({.url = options.robot}, topics_of(options.topics), write);
  try {
    lost = run(base, options);
  } catch (const ConnectionError& error) {
    lost = error.what();
  }
  bag.finish(existing_at(options.output));
  for (const auto& [topic, count] : base.received()) {
    say("{}: {} of {}\n", options.output, counted(static_cast<std::size_t>(count), "message"),
        topic);
  }
  const bool is_interrupted = Interruption::is_asked() && (options.drive || options.seconds);
  if (is_interrupted || !lost.empty()) {
    say(stderr, "error: {}\n", is_interrupted ? "interrupted" : lost);
    return is_interrupted ? kInterrupted : kBadInput;
  }
  Diagnostics diagnostics;
  const BaseDrive drive = read_base_drive(options.output, diagnostics);
  print(diagnostics);
  if (!diagnostics.errors.empty()) return kBadInput;
  if (drive.samples.empty()) {
    say(stderr, "error: {}: the base did not move\n", options.output);
    return kBadInput;
  }
  say("{}: {}\n", options.output, counted(drive.samples.size(), "sample"));
  const InputOptions next{
      .urdf = options.urdf, .config = options.config, .samples = {options.output}};
  say("next: {}\n", calibrate_command(next).str());
  return kDone;
}

}  // namespace kinecal::cli
