// From a recording to a calibrated robot, in C++: the samples of a file, the robot of a crate.
//
//   10_recording SAMPLES    a bag or a YAML file, such as generate_example_samples writes
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors.hpp"
#include "kinecal/files/recordings/read_recording.hpp"
#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"

namespace {

using namespace kinecal;

using Arm = Chain3d<"arm", Chain<mobile_manipulator::Robot, "base_link", "gripper_link">>;
using Head =
    Camera3d<"camera",
             Chain<mobile_manipulator::Robot, "base_link", "head_camera_rgb_optical_frame">>;
/// The first and last joint of the arm, and the pan joint, are left out: the camera's frame is free,
/// and the LEDs are on the last joint's axis or nearly so.
using HandEye =
    Crate<Arm, Head, JointOffset<"shoulder_lift_joint">, JointOffset<"upperarm_roll_joint">,
          JointOffset<"elbow_flex_joint">, JointOffset<"forearm_roll_joint">,
          JointOffset<"wrist_flex_joint">, JointOffset<"wrist_roll_joint">,
          DepthIntrinsics<"camera">, FrameOffset<"head_pan_joint">,
          FrameOffset<"head_camera_rgb_joint", Axes::xyz>,
          Block<"hand_eye", PointToPoint, "camera", "arm">>;

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: 10_recording SAMPLES\n");
    return 1;
  }
  Diagnostics diagnostics;
  const Recording recording = read_recording(argv[1], diagnostics);
  for (const std::string& error : diagnostics.errors) std::fprintf(stderr, "%s\n", error.c_str());
  if (!diagnostics.errors.empty()) return 1;

  HandEye crate;
  crate.block<"hand_eye">().options.sigma = 0.001;  // the camera is good to 1 mm
  crate.block<"hand_eye">().options.loss = {LossType::huber, 3.0};
  try {
    const CrateResult<HandEye> result = calibrate(crate, recording.samples);
    const BlockStatistics& hand_eye = result.blocks.front();
    std::printf("%s\n", result.termination.c_str());
    std::printf("hand_eye: %d points, median %.2f mm before, %.2f mm after\n",
                static_cast<int>(hand_eye.count), 1e3 * hand_eye.before.median,
                1e3 * hand_eye.after.median);
    for (const int i : result.calibrated) {
      const Parameter& parameter = result.table[i];
      std::printf("  %-24s %9.5f %s\n", parameter.name.c_str(), parameter.value,
                  parameter.unit.c_str());
    }
    return result.converged && hand_eye.after.median < 0.5 * hand_eye.before.median ? 0 : 1;
  } catch (const std::invalid_argument& e) {  // a sample that does not fit the robot
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
