// The names of a hand-eye calibration without a URDF: of its links, joints, frames and sensors.
//
//   base_link --flange_joint, floating--> flange        the poses
//   base_link or flange --camera_joint, fixed--> camera the camera beside the robot, or on its hand; several have
//                                                       names of their own: left, on left_joint
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinecal {

/// The names in hand_eye_urdf() and in what read_hand_eye_samples() reads.
struct HandEyeNames {
  static constexpr const char* kBase = "base_link";
  static constexpr const char* kFlange = "flange";
  static constexpr const char* kFlangeJoint = "flange_joint";
  static constexpr const char* kCamera = "camera";  ///< its optical frame, and its sensor
  static constexpr const char* kCameraJoint = "camera_joint";
  static constexpr const char* kTarget = "target";  ///< the frame of the board or object
  static constexpr const char* kObject = "object";  ///< the sensor that holds the object
};

}  // namespace kinecal
