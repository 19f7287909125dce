// UBR-1: four LEDs in the gripper and the floor, seen by the depth camera in the head.
//
// The parameters are those of Fetch, its successor.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/ubr1.hpp"
#include "simulated.hpp"

namespace ubr1 {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "base_link", Tip>;

struct Arm : Chain3d<"arm", To<"wrist_roll_link">> {
  static constexpr examples::Target kTarget = {2, 2, 0.035, 0.046, {0.0445, 0.0, 0.0269}, true};
};
using Camera = Camera3d<"camera", To<"head_camera_rgb_optical_frame">>;

/// Samples of the LEDs do not show the floor.
struct OnFloor : Block<"ground_plane", PointToPlane, "camera"> {
  OnFloor() { options.exclusive = true; }
};

using HandEye =
    Crate<Arm, Camera, JointOffset<"shoulder_pan_joint">, JointOffset<"shoulder_lift_joint">,
          JointOffset<"upperarm_roll_joint">, JointOffset<"elbow_flex_joint">,
          JointOffset<"forearm_roll_joint">, JointOffset<"wrist_flex_joint">,
          JointOffset<"wrist_roll_joint">, JointOffset<"head_tilt_joint">,
          FrameOffset<"head_pan_joint">, FrameOffset<"head_camera_rgb_joint">,
          DepthIntrinsics<"camera">, Block<"hand_eye", PointToPoint, "camera", "arm">>;
using Ground = Crate<Camera, DepthIntrinsics<"camera">, OnFloor>;
using Ubr1 = Crate<HandEye, Ground>;

}  // namespace ubr1
