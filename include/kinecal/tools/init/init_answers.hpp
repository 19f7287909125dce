// The answers to the questions of `kinecal init`: the facts about a robot and its surroundings that
// a first configuration needs.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// The kinds of targets that a robot is measured against: where they are, and what sees them.
enum class InitTarget {
  leds,
  checkerboard,
  world_checkerboard,
  tracker,
  ground,
  robot,
  tool,
  point,
  sockets,
  plane,
  line,
  sphere,
  bar,
  distance,
  grip,
  gravity
};

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
inline constexpr std::array<InitTargetWord, 20> kInitTargets = {{
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
    {InitTarget::point, InitBoard::checkerboard, "point",
     "nothing measures: the tip stays in one place, such as a cone, in many orientations"},
    {InitTarget::tool, InitBoard::checkerboard, "tool",
     "the same for the tool's centre point alone: four poses or more, the joints as they are"},
    {InitTarget::sockets, InitBoard::checkerboard, "sockets",
     "nothing measures: a ball or tip in several places, their distances known or not"},
    {InitTarget::plane, InitBoard::checkerboard, "plane",
     "nothing measures: the tip touches a table or a plate"},
    {InitTarget::line, InitBoard::checkerboard, "line",
     "nothing measures: the tip touches an edge or a taut wire"},
    {InitTarget::sphere, InitBoard::checkerboard, "sphere",
     "nothing measures: the tip touches a ball"},
    {InitTarget::bar, InitBoard::checkerboard, "bar",
     "nothing measures: a ball bar from the tip to a socket"},
    {InitTarget::distance, InitBoard::checkerboard, "distance",
     "a dial gauge or a distance sensor on the arm, against a plane: one number a pose"},
    {InitTarget::grip, InitBoard::checkerboard, "grip",
     "nothing measures: both hands of a robot hold one rigid thing, such as a board or a bar"},
    {InitTarget::gravity, InitBoard::checkerboard, "gravity",
     "an accelerometer on the arm, which reads gravity at rest"},
}};

/// The word for a mobile base, which is not measured against a target: see initial_base.hpp.
inline constexpr std::string_view kBaseTarget = "base";
/// The word for a magnetometer, which is measured against the field of the earth: see magnetometer_config.hpp.
inline constexpr std::string_view kMagnetometerTarget = "magnetometer";

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
  return words + ", " + std::string(kBaseTarget) + ", " + std::string(kMagnetometerTarget);
}

/// True if the tip of an arm touches the target, or what it carries reads gravity: joints are all that is recorded, and at
/// most a few numbers beside them.
[[nodiscard]] constexpr bool is_touched(InitTarget target) {
  return target >= InitTarget::tool;
}
/// True if the target needs an arm.
[[nodiscard]] constexpr bool needs_arm(InitTarget target) {
  return target == InitTarget::leds || target == InitTarget::checkerboard ||
         target == InitTarget::tracker || is_touched(target);
}
/// True if the target needs a camera.
[[nodiscard]] constexpr bool needs_camera(InitTarget target) {
  return target != InitTarget::tracker && !is_touched(target);
}
/// True if the target has a length that may be known: of a bar, between two sockets, from a ball's center to the tip.
[[nodiscard]] constexpr bool has_length(InitTarget target) {
  return target == InitTarget::sockets || target == InitTarget::sphere || target == InitTarget::bar;
}

/// True if a place that the tip touches may be known on the link that carries it: of a point, of sockets, of the center of
/// a sphere and the end of a bar.
[[nodiscard]] constexpr bool has_place(InitTarget target) {
  return target == InitTarget::point || target == InitTarget::tool || has_length(target);
}

/// True if the target is a board, in the gripper or in the world.
[[nodiscard]] constexpr bool is_board(InitTarget target) {
  return target == InitTarget::checkerboard || target == InitTarget::world_checkerboard;
}

/// True if points are recorded in a frame of the target, which is not in the URDF.
[[nodiscard]] constexpr bool needs_target_frame(InitTarget target) {
  return target != InitTarget::leds && target != InitTarget::ground &&
         target != InitTarget::robot && target != InitTarget::grip;
}

/// A further arm that touches the same places.
struct FurtherArm {
  std::string arm;           ///< link at its end, and sensor_name of its tip
  std::string target_frame;  ///< of its tip
};

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
  std::vector<FurtherArm> more_arms = {};         ///< that touch the same points or sockets
  std::string tracker_frame = {};  ///< of a laser tracker, the frame_id of its measurements
  InitBoard board = InitBoard::checkerboard;  ///< of a board
  std::string holder = {};   ///< sensor_name of what holds the target; empty: "arm" or "board"
  std::string tracker = {};  ///< sensor_name of a laser tracker; empty: "tracker"
  std::string carrier =
      {};  ///< link that carries what is touched; empty: the base; of a grip: the other hand
  std::vector<std::string> places =
      {};                             ///< frames of what is touched: one for each socket, else one
  std::optional<double> length = {};  ///< metres, if it is known: see has_length()
  std::vector<Vector3<double>> layout =
      {};  ///< metres: places of sockets in one frame; empty: not known
  std::optional<Vector3<double>> at =
      {};  ///< metres, in the carrier: a place on it that is known: see has_place()
  Vector3<double> center =
      Vector3<double>::Zero();           ///< where a sphere or the end of a bar may be, in the base
  bool known_lens = false;               ///< the intrinsics of the camera are held
  std::vector<std::string> stands = {};  ///< joints on which robots stand at a pose to be found
};

/// The sensor_name of what holds the target: the arm, or a board in the world.
[[nodiscard]] inline std::string holder_of(const InitAnswers& answers) {
  if (!answers.holder.empty()) return answers.holder;
  return answers.target == InitTarget::world_checkerboard ? "board" : "arm";
}

/// The sensor_name of a laser tracker, or of what is touched.
[[nodiscard]] inline std::string tracker_of(const InitAnswers& answers) {
  if (!answers.tracker.empty()) return answers.tracker;
  return is_touched(answers.target) ? "touched" : "tracker";
}

}  // namespace kinecal
