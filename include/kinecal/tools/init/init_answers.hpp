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

/// The targets that a robot is measured against.
enum class InitTarget { leds, checkerboard, world_checkerboard, tracker, ground };

/// A target, its name on the command line, and a one-line explanation.
struct InitTargetWord {
  InitTarget target;      ///< the target
  std::string_view word;  ///< its name on the command line
  std::string_view says;  ///< the explanation
};

/// All targets, in the order of InitTarget.
inline constexpr std::array<InitTargetWord, 5> kInitTargets = {{
    {InitTarget::leds, "leds",
     "LEDs (or other points at known places) on the gripper, seen by a camera"},
    {InitTarget::checkerboard, "checkerboard", "a checkerboard in the gripper, seen by a camera"},
    {InitTarget::world_checkerboard, "world_checkerboard",
     "a checkerboard that stands in the world, seen by a camera that moves"},
    {InitTarget::tracker, "tracker", "a reflector on the arm, followed by a laser tracker"},
    {InitTarget::ground, "ground", "the floor, seen by a depth camera"},
}};

/// The name of a target on the command line.
[[nodiscard]] inline std::string_view to_string(InitTarget target) {
  return kInitTargets[static_cast<std::size_t>(target)].word;
}

/// The target with this name on the command line; nullopt if there is none.
[[nodiscard]] inline std::optional<InitTarget> init_target(std::string_view word) {
  for (const InitTargetWord& known : kInitTargets) {
    if (known.word == word) return known.target;
  }
  return std::nullopt;
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

/// True if points are recorded in a frame of the target, which is not in the URDF.
[[nodiscard]] constexpr bool needs_target_frame(InitTarget target) {
  return target != InitTarget::leds && target != InitTarget::ground;
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
};

}  // namespace kinecal
