// UR5e: a laser tracker measures a reflector on the flange.
//
// The poses of tracker and reflector are free, so the first and the last joint are not: the frames
// absorb their zeros.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/ur5e.hpp"

namespace ur5e {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "base", Tip>;

using Tracking = Crate<Chain3d<"tracker", To<"tracker">>, Chain3d<"arm", To<"reflector">>,
                       FrameOffset<"tracker_joint">, FrameOffset<"reflector_joint", Axes::xyz>,
                       Block<"tracking", PointToPoint, "tracker", "arm">>;

/// The zeros of the joints; lengths are as drawn.
using Ur5e = Crate<Tracking, JointOffset<"shoulder_lift_joint">, JointOffset<"elbow_joint">,
                   JointOffset<"wrist_1_joint">, JointOffset<"wrist_2_joint">>;

/// All observable kinematics: of parallel joints, one length and one zero stand for the others.
inline constexpr Axes kXa = {.x = true, .a = true}, kXya = {.x = true, .y = true, .a = true};
inline constexpr Axes kXabc = {.x = true, .a = true, .b = true, .c = true};
using Ur5eAll = Crate<Tracking, JointOffset<"shoulder_lift_joint">, JointOffset<"wrist_2_joint">,
                      FrameOffset<"shoulder_lift_joint", kXa>, FrameOffset<"elbow_joint", kXabc>,
                      FrameOffset<"wrist_1_joint", kXabc>, FrameOffset<"wrist_2_joint", kXya>,
                      FrameOffset<"wrist_3_joint", kXya>>;

}  // namespace ur5e
