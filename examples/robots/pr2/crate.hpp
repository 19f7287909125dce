// PR2: a checkerboard in each gripper, seen by the Kinect on the head.
//
// The poses of the boards are free, so the last joint of each arm is not: the board's frame absorbs
// its zero.  Two arms determine the zero of the head pan; one arm alone could follow it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/pr2.hpp"

namespace pr2 {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "torso_lift_link", Tip>;

using Camera = Camera3d<"camera", To<"head_mount_kinect_rgb_optical_frame">>;
using Head = Crate<Camera, JointOffset<"head_tilt_joint">, FrameOffset<"head_pan_joint">,
                   FrameOffset<"head_mount_kinect_rgb_joint">, DepthIntrinsics<"camera">>;

using LeftArm = Crate<Head, Chain3d<"left_arm", To<"l_gripper_tool_frame">>,
                      JointOffset<"l_shoulder_pan_joint">, JointOffset<"l_shoulder_lift_joint">,
                      JointOffset<"l_upper_arm_roll_joint">, JointOffset<"l_elbow_flex_joint">,
                      JointOffset<"l_forearm_roll_joint">, JointOffset<"l_wrist_flex_joint">,
                      FrameOffset<"l_gripper_tool_joint">,
                      Block<"left_hand_eye", PointToPoint, "camera", "left_arm">>;
using RightArm = Crate<Head, Chain3d<"right_arm", To<"r_gripper_tool_frame">>,
                       JointOffset<"r_shoulder_pan_joint">, JointOffset<"r_shoulder_lift_joint">,
                       JointOffset<"r_upper_arm_roll_joint">, JointOffset<"r_elbow_flex_joint">,
                       JointOffset<"r_forearm_roll_joint">, JointOffset<"r_wrist_flex_joint">,
                       FrameOffset<"r_gripper_tool_joint">,
                       Block<"right_hand_eye", PointToPoint, "camera", "right_arm">>;
using Pr2 = Crate<LeftArm, RightArm>;

}  // namespace pr2
