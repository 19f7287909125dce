// Switchable LEDs of a robot, and the settings for finding them.
//
// Source: Fetch paper, III-A; settings as in upstream's capture.yaml.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include "kinecal/capture/finders/region.hpp"

namespace kinecal {

/// An LED.
struct Led {
  int code = 0;                                        ///< code that lights only this one; not 0
  std::string name;                                    ///< for messages, such as "led1"
  Vector3<double> position = Vector3<double>::Zero();  ///< (3) metres, in the frame of the LEDs
};

/// Settings to find LEDs: find_leds().  Names and defaults are upstream's.
struct LedFinder {
  std::string camera_sensor = "camera";   ///< sensor that observes points in the optical frame
  std::string chain_sensor = "arm";       ///< sensor that holds the LEDs
  std::string frame = "wrist_roll_link";  ///< link of the LEDs (gripper_led_frame)
  std::vector<Led> leds;                  ///< at least one
  /// Smallest accumulated difference of an LED's brightest pixel, as a sum of red, green and blue
  /// over all switches.  A grey level counts three times.
  double threshold = 1000.0;
  int max_iterations = 50;          ///< switches at most, on and off, of all LEDs together
  double max_error = 0.1;           ///< metres, from the LED's position in the robot model
  double max_inconsistency = 0.01;  ///< metres: distance between two LEDs against the list's
  Stamp settle = std::chrono::milliseconds(100);  ///< from a switch to the exposure of a view
  /// Pose of the camera in the frame of the LEDs; empty: LEDs may be anywhere in the image.
  PoseOfView frame_T_camera;

  /// Why a view cannot be searched, whatever it shows; empty if it can.
  [[nodiscard]] static std::string fault(const View& view);

  /// Takes the pose of the camera in the frame of the LEDs.
  void place_on(const CameraIn& camera_in) { frame_T_camera = camera_in(frame); }

  /// The name of an LED in messages: "LED 1 (led2)".
  [[nodiscard]] std::string called(std::size_t led) const;
};

/// The point of an LED.
struct PlacedLed {
  std::size_t led;           ///< its place in the list
  Vector3<double> p_camera;  ///< (3) metres, in the optical frame
};

/// Drops LEDs whose distances to others differ from those of the list, the worst first.
/// @param[in,out] placed  LEDs that were found
/// @return                a sentence about each dropped LED
[[nodiscard]] std::vector<std::string> drop_inconsistent(const LedFinder& finder,
                                                         std::vector<PlacedLed>& placed);

}  // namespace kinecal
