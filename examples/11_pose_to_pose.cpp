// Poses, not points: motion capture follows a rigid body on the gripper.
//
// The system reports position and orientation of the body in its own frame.  Nobody knows where the
// system stands or how the body is mounted: both are virtual frames, which the samples determine.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors/pose_to_pose.hpp"
#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

// Noise of the system: 0.2 mm and 0.5 mrad.  One over them weights translations and rotations.
constexpr double kPosition = 2e-4, kAngle = 5e-4;
struct Tracking : Block<"tracking", PoseToPose, "body", "mocap"> {
  Tracking() { error = {1.0 / kPosition, 1.0 / kAngle}; }
};

using Example = mobile_manipulator::Robot;
using Body = Chain6d<"body", Chain<Example, "base_link", "gripper_link">>;
using Mocap = Chain6d<"mocap", Chain<Example, "base_link", "base_link">>;
// The first joint turns with the system, the last one with the body: their zeros are not free.
using Tracked = Crate<Body, Mocap, JointOffset<"shoulder_lift_joint">,
                      JointOffset<"upperarm_roll_joint">, JointOffset<"elbow_flex_joint">,
                      JointOffset<"forearm_roll_joint">, JointOffset<"wrist_flex_joint">,
                      VirtualFrame<"body_mount">, VirtualFrame<"mocap_stand">, Tracking>;

/// A sample at a random pose.
Sample measure(const TrueRobot& robot, SeededRandom& random) {
  Sample sample = random_pose(robot.robot(), random);
  Positions positions;
  for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
    positions[sample.joint_names[i]] = sample.joint_positions[i];
  }
  const Pose<double> stand = robot.pose("base_link", "base_link", positions, "mocap_stand"),
                     body = robot.pose("base_link", "gripper_link", positions, "body_mount");
  const Pose<double> seen = stand.inverse() * body;
  const Vector3<double> noise = kAngle * random.normal_vector();
  sample.observations = {
      {"body", {{"body_mount", Vector3<double>::Zero(), Matrix3<double>::Identity()}}},
      {"mocap",
       {{"mocap_stand", seen.translation + kPosition * random.normal_vector(),
         seen.rotation * exp(noise)}}}};
  return sample;
}

}  // namespace

int main() {
  ParameterTable truth = Tracked().table({});
  SeededRandom random(11);
  for (int i = 0; i < truth.size(); ++i) {
    const bool of_stand = truth[i].name.starts_with("mocap_stand");
    truth[i].value = random.uniform(-1.0, 1.0) * (of_stand ? 0.5 : 0.05);
  }
  const Robot robot = Tracked::robot();
  const TrueRobot true_robot(robot, truth, {"body_mount", "mocap_stand"});
  std::vector<Sample> samples;
  for (int n = 0; n < 60; ++n) samples.push_back(measure(true_robot, random));

  const CrateResult<Tracked> result = calibrate(Tracked(), samples);

  const BlockStatistics& fit = result.blocks.front();
  std::printf("weighted residual: %.1f RMS before, %.2f after; noise alone gives 1\n",
              fit.before.rms / std::sqrt(6.0), fit.after.rms / std::sqrt(6.0));
  bool all_found = result.converged;
  for (const int i : result.calibrated) {
    const Parameter& found = result.table[i];
    const double expected = truth[found.name].value;
    std::printf("  %-20s true %8.4f  found %8.4f %s\n", found.name.c_str(), expected, found.value,
                found.unit.c_str());
    all_found = all_found && std::abs(found.value - expected) < 2e-3;
  }
  return all_found ? 0 : 1;
}
