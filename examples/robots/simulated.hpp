// Optional properties of a crate's sensors for the simulation; all have defaults.
//
//   struct Arm : Chain3d<"arm", From<"gripper_led_frame">> {
//     static constexpr Target kTarget = {.columns = 2, .rows = 2};
//   };
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace kinecal::examples {

/// Points at the tip of a chain: a grid in the x-y plane of that frame, such as LEDs or the corners
/// of a checkerboard.  A camera sees it from both sides, but not edge-on.
struct Target {
  int columns = 5, rows = 4;            ///< along x and y
  double step_x = 0.03, step_y = 0.03;  ///< metres
  std::array<double, 3> centre = {};    ///< metres, in the frame
  bool one_sided = false;               ///< seen from above only, where z is positive
};

/// One point, for a tracker.
inline constexpr Target kReflector = {.columns = 1, .rows = 1};

/// Range and noise of a sensor.
struct Measuring {
  double near = 0.3, far = 1.5;  ///< of a camera: range of depths, metres
  double pixel = 0.6;            ///< of a camera: standard deviation, pixels
  double depth = 0.001;          ///< of a depth camera: at 1 m, metres; it grows with the square
  double point = 5e-5;           ///< of a tracker: of each coordinate, metres
};

/// A camera that detects corners in its image, in place of LEDs in a point cloud.
inline constexpr Measuring kPinhole = {.near = 0.2, .pixel = 0.3};

}  // namespace kinecal::examples
