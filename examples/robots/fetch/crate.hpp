// Fetch: four LEDs in the gripper and the floor, seen by the depth camera in the head.
//
// Free are seven joints of the arm, the head tilt, the frames of head and camera, and the camera
// itself.  The zero of the pan joint is the yaw of its frame.
// Source: Fetch paper, III.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/fetch.hpp"
#include "simulated.hpp"

namespace fetch {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "base_link", Tip>;

struct Arm : Chain3d<"arm", To<"gripper_led_frame">> {
  static constexpr examples::Target kTarget = {2, 2, 0.053, 0.071, {}, true};
};
using Camera = Camera3d<"camera", To<"head_camera_rgb_optical_frame">>;

/// At 0.8 m the camera measures an LED to 1 mm; beyond 3 sigma it is an outlier.
struct SameLeds : Block<"hand_eye", PointToPoint, "camera", "arm"> {
  SameLeds() {
    options.sigma = 0.001;
    options.loss = {LossType::huber, 3.0};
  }
};
/// At 1.5 m the camera measures the floor to 3 mm; samples of the LEDs do not show it.
struct OnFloor : Block<"ground_plane", PointToPlane, "camera"> {
  OnFloor() {
    options.sigma = 0.003;
    options.exclusive = true;
  }
};
/// The head tilt trades with the pitch of the camera's frame, and a common yaw of arm and head is
/// not observable: the prior keeps them close to the drawing.
struct KeepCamera : PriorOn<"restrict_camera", "head_camera_rgb_joint"> {
  KeepCamera() { rotation_scale = 5.0; }
};
struct KeepShoulder : PriorOn<"restrict_shoulder_pan", "shoulder_pan_joint"> {
  KeepShoulder() { joint_scale = 5.0; }
};

using HandEye =
    Crate<Arm, Camera, JointOffset<"shoulder_pan_joint">, JointOffset<"shoulder_lift_joint">,
          JointOffset<"upperarm_roll_joint">, JointOffset<"elbow_flex_joint">,
          JointOffset<"forearm_roll_joint">, JointOffset<"wrist_flex_joint">,
          JointOffset<"wrist_roll_joint">, JointOffset<"head_tilt_joint">,
          DepthIntrinsics<"camera">, FrameOffset<"head_pan_joint">,
          FrameOffset<"head_camera_rgb_joint">, SameLeds, KeepCamera, KeepShoulder>;
using Ground = Crate<Camera, DepthIntrinsics<"camera">, OnFloor>;
using Fetch = Crate<HandEye, Ground>;
using FetchWithTorso =
    Crate<Fetch, JointOffset<"torso_lift_joint">>;  // the floor makes it observable

}  // namespace fetch
