// Three sensors in one error block: a bead on a string.
//
// A string is tied to a hook at the robot's base and to the gripper.  A bead is glued to it
// somewhere, and the depth camera sees the bead.  Hook, bead and gripper are on one line, and the
// bead divides it in an unknown ratio: a parameter of the block.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

/// Measured position of the bead minus the one expected from hook and gripper; metres.
struct BeadOnString {
  static constexpr const char *kType = "bead_on_string", *kUnit = "m";
  static constexpr std::array kParameters = {ParameterInfo{"ratio", "1", 0.5, 0.0, 1.0}};

  template <class S>
  Vector3<S> operator()(const Vector3<S>& hook, const Vector3<S>& bead, const Vector3<S>& gripper,
                        const std::array<S, 1>& own) const {
    return bead - hook - (gripper - hook) * own[0];
  }
};
static_assert(kSensors<BeadOnString> == 3);

using Example = mobile_manipulator::Robot;
using Hook = Chain3d<"hook", Chain<Example, "base_link", "base_link">>;
using Camera = Camera3d<"camera", Chain<Example, "base_link", "head_camera_rgb_optical_frame">>;
using Arm = Chain3d<"arm", Chain<Example, "base_link", "gripper_link">>;
using OnString = Crate<Hook, Camera, Arm, JointOffset<"shoulder_pan_joint">,
                       JointOffset<"shoulder_lift_joint">, JointOffset<"elbow_flex_joint">,
                       JointOffset<"head_tilt_joint">, BlockParameters<"string", "ratio">,
                       Block<"string", BeadOnString, "hook", "camera", "arm">>;

const Vector3<double> kHook(0.6, -0.3, 0.5);  // metres, in base_link

/// A sample at a random pose; the camera sees the bead with 0.5 mm of noise.
Sample measure(const ParameterTable& truth, SeededRandom& random) {
  static const Robot robot = OnString::robot();
  for (;;) {
    Sample sample = random_pose(robot, random);
    const Pose<double> gripper = true_pose(robot, truth, "base_link", "gripper_link", sample),
                       camera = true_pose(robot, truth, "base_link",
                                          "head_camera_rgb_optical_frame", sample);
    const double ratio = truth["string_ratio"].value;
    const Vector3<double> bead = kHook + (gripper.translation - kHook) * ratio;
    const Vector3<double> seen = camera.inverse() * bead + 5e-4 * random.normal_vector();
    if (!is_in_image(intrinsics_of(example_camera_info()), seen)) continue;
    sample.observations = {
        {"hook", {{"base_link", kHook}}},
        {"camera", {{"head_camera_rgb_optical_frame", seen}}, example_camera_info()},
        {"arm", {{"gripper_link", Vector3<double>::Zero()}}}};
    return sample;
  }
}

}  // namespace

int main() {
  ParameterTable truth = OnString().table({});
  truth["shoulder_pan_joint"].value = -1.0 * kDegree;
  truth["shoulder_lift_joint"].value = 1.5 * kDegree;
  truth["elbow_flex_joint"].value = -2.0 * kDegree;
  truth["head_tilt_joint"].value = 0.8 * kDegree;
  truth["string_ratio"].value = 0.62;
  SeededRandom random(12);
  std::vector<Sample> samples;
  for (int n = 0; n < 100; ++n) samples.push_back(measure(truth, random));

  const CrateResult<OnString> result = calibrate(OnString(), samples);

  const BlockStatistics& fit = result.blocks.front();
  std::printf("bead: %.2f mm RMS before, %.2f mm after\n", 1e3 * fit.before.rms,
              1e3 * fit.after.rms);
  bool all_found = result.converged && fit.after.rms < 2e-3;
  for (const int i : result.calibrated) {
    const Parameter& found = result.table[i];
    const double expected = truth[found.name].value;
    std::printf("  %-20s true %8.4f  found %8.4f %s\n", found.name.c_str(), expected, found.value,
                found.unit.c_str());
    all_found = all_found && std::abs(found.value - expected) < 2e-3;
  }
  return all_found ? 0 : 1;
}
