// TIAGo: a checkerboard in place of the gripper, seen by the depth camera in the head.
//
// The pose of the board is free, so the last joint is not: the board's frame absorbs its zero.  The
// first joint is not free either, because arm and head could turn together.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/tiago.hpp"

namespace tiago {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "torso_lift_link", Tip>;

using Arm = Chain3d<"arm", To<"arm_chessboard_link">>;
using Camera = Camera3d<"camera", To<"xtion_rgb_optical_frame">>;

using Tiago =
    Crate<Arm, Camera, JointOffset<"arm_2_joint">, JointOffset<"arm_3_joint">,
          JointOffset<"arm_4_joint">, JointOffset<"arm_5_joint">, JointOffset<"arm_6_joint">,
          FrameOffset<"arm_chessboard_joint">, JointOffset<"head_2_joint">,
          FrameOffset<"head_1_joint">, FrameOffset<"xtion_rgb_joint">, DepthIntrinsics<"camera">,
          Block<"hand_eye", PointToPoint, "camera", "arm">>;

}  // namespace tiago
