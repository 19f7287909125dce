// What a crate may say of its sensors for the simulation of samples; all of it has defaults.
//
//   struct Arm : Chain3d<"arm", From<"gripper_led_frame">> {
//     static constexpr Target kTarget = {.columns = 2, .rows = 2};
//   };
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kinecal::examples {

/// Points that a chain carries at its tip: a grid in the x-y plane of that frame, such as the
/// corners of a checkerboard or LEDs.  A camera sees it from either side, but not from its edge.
struct Target {
  int columns = 5, rows = 4;            ///< along x and y
  double step_x = 0.03, step_y = 0.03;  ///< metres
  std::array<double, 3> centre = {};    ///< metres, in the frame
  bool one_sided = false;               ///< seen from above only, where z is positive
};

/// One point: what a tracker follows.
inline constexpr Target kReflector = {.columns = 1, .rows = 1};

/// How a sensor measures.
struct Measuring {
  double near = 0.3, far = 1.5;  ///< of a camera: the depths of what it sees, metres
  double pixel = 0.6;            ///< of a camera: standard deviation, pixels
  double depth = 0.001;          ///< of a depth camera: at 1 m, metres; it grows with the square
  double point = 5e-5;           ///< of a tracker: of each coordinate, metres
};

/// A camera that finds corners in its image, not LEDs in points.
inline constexpr Measuring kPinhole = {.near = 0.2, .pixel = 0.3};

}  // namespace kinecal::examples
