// The answers to the questions of `kinecal init`: the facts about a robot and its surroundings that
// a first configuration needs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kinecal {

/// The kinds of targets that a robot is measured against: where they are, and what sees them.
enum class InitTarget { leds, checkerboard, world_checkerboard, tracker, ground, robot };

/// The boards of `checkerboard` and `world_checkerboard`.
enum class InitBoard { checkerboard, apriltag, charuco };

/// A target, its name on the command line, and a one-line explanation.
struct InitTargetWord {
  InitTarget target;      ///< its kind
  InitBoard board;        ///< of a board
  std::string_view word;  ///< its name on the command line
  std::string_view says;  ///< the explanation
};

/// All targets, in the order of questions.
inline constexpr std::array<InitTargetWord, 10> kInitTargets = {{
    {InitTarget::leds, InitBoard::checkerboard, "leds",
     "LEDs (or other points at known places) on the gripper, seen by a camera"},
    {InitTarget::checkerboard, InitBoard::checkerboard, "checkerboard",
     "a checkerboard in the gripper, seen by a camera"},
    {InitTarget::checkerboard, InitBoard::apriltag, "apriltag",
     "a grid of AprilTags (also Kalibr's) in the gripper"},
    {InitTarget::checkerboard, InitBoard::charuco, "charuco", "a ChArUco board in the gripper"},
    {InitTarget::world_checkerboard, InitBoard::checkerboard, "world_checkerboard",
     "a checkerboard that stands in the world, seen by a camera that moves"},
    {InitTarget::world_checkerboard, InitBoard::apriltag, "world_apriltag",
     "a grid of AprilTags that stands in the world"},
    {InitTarget::world_checkerboard, InitBoard::charuco, "world_charuco",
     "a ChArUco board that stands in the world"},
    {InitTarget::tracker, InitBoard::checkerboard, "tracker",
     "a reflector on the arm, followed by a laser tracker"},
    {InitTarget::ground, InitBoard::checkerboard, "ground", "the floor, seen by a depth camera"},
    {InitTarget::robot, InitBoard::checkerboard, "robot",
     "the robot itself: its meshes, in clouds of a depth camera or in masks"},
}};

/// The name of a target on the command line.
[[nodiscard]] constexpr std::string_view to_string(InitTarget target,
                                                   InitBoard board = InitBoard::checkerboard) {
  for (const InitTargetWord& known : kInitTargets) {
    if (known.target == target && known.board == board) return known.word;
  }
  return to_string(target);
}

/// The target with this name on the command line; nullopt if absent.
[[nodiscard]] inline std::optional<InitTargetWord> init_target(std::string_view word) {
  for (const InitTargetWord& known : kInitTargets) {
    if (known.word == word) return known;
  }
  return std::nullopt;
}

/// The names of all targets: "leds, checkerboard, ...".
[[nodiscard]] inline std::string init_target_words() {
  std::string words;
  for (const InitTargetWord& known : kInitTargets) {
    words += (words.empty() ? "" : ", ") + std::string(known.word);
  }
  return words;
}

/// True if the target needs an arm.
[[nodiscard]] constexpr bool needs_arm(InitTarget target) {
  return target == InitTarget::leds || target == InitTarget::checkerboard ||
         target == InitTarget::tracker;
}
/// True if the target needs a camera.
[[nodiscard]] constexpr bool needs_camera(InitTarget target) {
  return target != InitTarget::tracker;
}

/// True if the target is a board, in the gripper or in the world.
[[nodiscard]] constexpr bool is_board(InitTarget target) {
  return target == InitTarget::checkerboard || target == InitTarget::world_checkerboard;
}

/// True if points are recorded in a frame of the target, which is not in the URDF.
[[nodiscard]] constexpr bool needs_target_frame(InitTarget target) {
  return target != InitTarget::leds && target != InitTarget::ground && target != InitTarget::robot;
}

/// The user's answers.  Links are links of the URDF; fields that a target does not need stay empty.
struct InitAnswers {
  InitTarget target = InitTarget::leds;  ///< the target
  bool with_ground = false;              ///< the camera also sees the floor, in separate samples
  std::string base;                      ///< link in which all measurements are compared
  std::string arm;                       ///< link at the end of the arm
  std::string camera;                    ///< link of the camera: its optical frame, z ahead
  std::string camera_type = "camera3d";  ///< camera3d (points in metres) or camera2d (pixels)
  std::string camera_name = "camera";    ///< sensor_name of the samples, prefix of its parameters
  std::string target_frame = {};  ///< of the board or the reflector, the frame_id of its points
  std::vector<std::string> more_reflectors = {};  ///< frames of further ones, with a tracker
  std::string tracker_frame = {};  ///< of a laser tracker, the frame_id of its measurements
  InitBoard board = InitBoard::checkerboard;  ///< of a board
  std::string holder = {};   ///< sensor_name of what holds the target; empty: "arm" or "board"
  std::string tracker = {};  ///< sensor_name of a laser tracker; empty: "tracker"
};

/// The sensor_name of what holds the target: the arm, or a board in the world.
[[nodiscard]] inline std::string holder_of(const InitAnswers& answers) {
  if (!answers.holder.empty()) return answers.holder;
  return answers.target == InitTarget::world_checkerboard ? "board" : "arm";
}

/// The sensor_name of a laser tracker.
[[nodiscard]] inline std::string tracker_of(const InitAnswers& answers) {
  return answers.tracker.empty() ? "tracker" : answers.tracker;
}

}  // namespace kinecal
