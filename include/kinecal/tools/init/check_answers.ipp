// Checks the answers of `kinecal init` before planning.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "kinecal/text/nearest_name.hpp"
#include "kinecal/tools/init/initial_config.hpp"

namespace kinecal::detail {

/// Checks the frames of several reflectors.
inline void check_reflectors(const Robot& robot, const InitAnswers& answers,
                             Diagnostics& diagnostics) {
  std::vector<std::string> before = {answers.target_frame, answers.tracker_frame};
  for (const std::string& frame : answers.more_reflectors) {
    check_init_frame(robot, "--target-frame", frame, diagnostics);
    if (std::find(before.begin(), before.end(), frame) != before.end()) {
      diagnostics.error({"--target-frame", 0},
                        "'" + frame + "' occurs twice; each reflector has a frame of its own");
    }
    before.push_back(frame);
  }
  if (!answers.more_reflectors.empty() && answers.target != InitTarget::tracker) {
    diagnostics.error({"--target-frame", 0},
                      "only a tracker has several reflectors; give one name");
  }
}

/// Checks the answers before planning.
/// @throws InputError  with all their errors
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
    check_reflectors(robot, answers, diagnostics);
  }
  if (target == InitTarget::tracker) {
    check_init_frame(robot, "--tracker-frame", answers.tracker_frame, diagnostics);
    if (answers.target_frame == answers.tracker_frame) {
      diagnostics.error({"--tracker-frame", 0},
                        "'" + answers.tracker_frame +
                            "' is the frame of the reflector too; give the tracker another one");
    }
  }
  const bool floor = target == InitTarget::ground || answers.with_ground;
  if (floor && target == InitTarget::tracker) {
    diagnostics.error(
        {"--target", 0},
        "tracker and ground have no parameters in common; make a configuration for each");
  } else if (floor && answers.camera_type == "camera2d") {
    diagnostics.error({"--camera-type", 0}, "the floor is seen by depth cameras only: camera3d");
  }
  diagnostics.throw_if_errors();
}

}  // namespace kinecal::detail
