// Panda: a camera on the hand observes a checkerboard on the table.
//
// The poses of camera and board are free, so the first and the last joint are not: the frames
// absorb their zeros.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/crate.hpp"
#include "kinecal/errors.hpp"
#include "robots/panda.hpp"
#include "simulated.hpp"

namespace panda {

using namespace kinecal;

template <FixedString Tip>
using To = Chain<Robot, "panda_link0", Tip>;

struct Board : Chain3d<"board", To<"checkerboard_link">> {
  static constexpr examples::Target kTarget = {.one_sided = true};  // it lies face up
};
using Camera = Camera2d<"camera", To<"camera_color_optical_frame">>;

using Panda =
    Crate<Board, Camera, JointOffset<"panda_joint2">, JointOffset<"panda_joint3">,
          JointOffset<"panda_joint4">, JointOffset<"panda_joint5">, JointOffset<"panda_joint6">,
          FrameOffset<"camera_joint">, FrameOffset<"checkerboard_joint">,
          CameraIntrinsics<"camera">, Block<"hand_eye", PointToPixel, "board", "camera">>;

}  // namespace panda
