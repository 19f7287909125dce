// A first calibration: an arm, a tracker that measures its gripper, 25 samples.
//
// A crate lists what observes what, and what may be wrong.  The compiler checks its names against
// the robot, which the build generates from the URDF (kinecal_add_robot in CMakeLists.txt).
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors.hpp"
#include "kinecal/procedure.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

using Arm = Chain3d<"arm", Chain<mobile_manipulator::Robot, "base_link", "gripper_link">>;
using Tracker = Chain3d<"tracker", Chain<mobile_manipulator::Robot, "base_link", "base_link">>;
using Shoulder = JointOffset<"shoulder_lift_joint">;
using Elbow = JointOffset<"elbow_flex_joint">;
using Gripper = FrameOffset<"gripper_axis", Axes{.x = true}>;  // along the wrist: its length
using Tracked = Crate<Arm, Tracker, Shoulder, Elbow, Gripper,
                      Block<"tracking", PointToPoint, "arm", "tracker">>;

/// What a real robot records: joint positions, and the gripper's origin as the tracker measures it.
Sample measure(const ParameterTable& truth, SeededRandom& random) {
  static const Robot robot = Tracked::robot();
  Sample sample = random_pose(robot, random);
  const Pose<double> gripper = true_pose(robot, truth, "base_link", "gripper_link", sample);
  const Vector3<double> seen = gripper.translation + 1e-4 * random.normal_vector();  // 0.1 mm
  sample.observations = {{"arm", {{"gripper_link", Vector3<double>::Zero()}}},
                         {"tracker", {{"base_link", seen}}}};
  return sample;
}

}  // namespace

int main() {
  ParameterTable truth = Tracked().table({});
  truth["shoulder_lift_joint"].value = -2.0 * kDegree;
  truth["elbow_flex_joint"].value = 1.5 * kDegree;
  truth["gripper_axis_x"].value = 0.004;
  SeededRandom random(1);
  std::vector<Sample> samples;
  for (int n = 0; n < 25; ++n) samples.push_back(measure(truth, random));

  samples[7].joint_positions[3] += 5.0 * kDegree;  // one joint was read while it still moved

  const JudgedCrate<Tracked> judged = calibrate_and_judge(Tracked(), samples);

  std::printf("verdict: %s\n", to_string(judged.judgement.verdict).data());
  for (const std::string& reason : judged.judgement.reasons) std::printf("  %s\n", reason.c_str());
  for (const LeftOutSample& sample : judged.left_out) {
    std::printf("sample %d is left out: %s\n", sample.number, sample.why.c_str());
  }
  const double shoulder = judged.value<Shoulder>(), elbow = judged.value<Elbow>();
  const double length = judged.value<Gripper>();
  std::printf("shoulder_lift_joint  %7.3f +- %.3f degrees, true -2\n", shoulder / kDegree,
              judged.deviation<Shoulder>() / kDegree);
  std::printf("elbow_flex_joint     %7.3f +- %.3f degrees, true 1.5\n", elbow / kDegree,
              judged.deviation<Elbow>() / kDegree);
  std::printf("gripper_axis_x       %7.3f +- %.3f mm, true 4\n", 1e3 * length,
              1e3 * judged.deviation<Gripper>());
  // 0.1 mm of noise at 0.3 m and more, averaged over 24 samples.
  const bool found = std::abs(shoulder + 2.0 * kDegree) < 1e-4 &&
                     std::abs(elbow - 1.5 * kDegree) < 2e-4 && std::abs(length - 0.004) < 1e-4;
  return judged.is_usable() && judged.left_out.size() == 1 && found ? 0 : 1;
}
