// A user's names for parts of a robot, beside those of kinecal.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/crate/crate.hpp"
#include "kinecal/errors/point_to_point.hpp"
#include "robots/fetch_example.hpp"

using namespace kinecal;

template <FixedString Tip>
using To = Chain<fetch::Robot, "torso_lift_link", Tip>;
using Arm = Chain3d<"arm", To<"wrist_roll_link">>;
using Camera = Camera3d<"camera", To<"head_camera_rgb_optical_frame">>;
using Lamp = Chain3d<"lamp", To<"gripper_link">>;
using HandEye = Crate<Arm, Camera, Lamp, JointOffset<"elbow_flex_joint">,
                      Block<"hand_eye", PointToPoint, "camera", "arm">>;

ParameterTable start() {
  HandEye crate;
  crate.block<"hand_eye">().options.sigma = 0.001;
  return crate.table({});
}
