// The workload as a crate: the same sensors, parameters and block as types.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fetch_robot.hpp"
#include "kinecal/crate/crate.hpp"
#include "kinecal/errors/point_to_point.hpp"

namespace kinecal::bench {

template <FixedString Tip>
using FromTorso = Chain<fetch::Robot, "torso_lift_link", Tip>;

/// Its parameters are in the order of fetch_parameters().
using FetchCrate =
    Crate<Chain3d<"arm", FromTorso<"wrist_roll_link">>,
          Camera3d<"camera", FromTorso<"head_camera_rgb_optical_frame">>,
          JointOffset<"shoulder_pan_joint">, JointOffset<"shoulder_lift_joint">,
          JointOffset<"upperarm_roll_joint">, JointOffset<"elbow_flex_joint">,
          JointOffset<"forearm_roll_joint">, JointOffset<"wrist_flex_joint">,
          JointOffset<"wrist_roll_joint">, JointOffset<"head_tilt_joint">,
          DepthIntrinsics<"camera">, FrameOffset<"head_camera_rgb_joint">,
          FrameOffset<"head_pan_joint">, Block<"hand_eye", PointToPoint, "camera", "arm">>;

}  // namespace kinecal::bench
