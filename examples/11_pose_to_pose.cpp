// Poses, not points: motion capture tracks a rigid body on the gripper.
//
// The system reports position and orientation of the body in its own frame.  The pose of the system
// and the mount of the body are unknown: both are virtual frames, which the samples determine.
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
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

  // Residuals are in units of the noise, so 1 RMS remains of each of the six components, less what
  // the parameters fit.
  const BlockStatistics& fit = result.blocks.front();
  const double components = 6.0 * static_cast<double>(fit.count), root = std::sqrt(6.0);
  const double noise = std::sqrt(1.0 - static_cast<double>(result.calibrated.size()) / components);
  std::printf("weighted residual: %.1f RMS before, %.2f after; noise alone gives %.2f\n",
              fit.before.rms / root, fit.after.rms / root, noise);
  const double chance = 4.0 * noise / std::sqrt(2.0 * components);  // four standard deviations
  bool as_expected = result.converged && std::abs(fit.after.rms / root - noise) < chance;
  constexpr double kFoundTo = 5e-4;  // metres, radians: the noise, which 60 samples make smaller
  for (const int i : result.calibrated) {
    const Parameter& found = result.table[i];
    const double expected = truth[found.name].value;
    std::printf("  %-20s true %8.4f  found %8.4f %s\n", found.name.c_str(), expected, found.value,
                found.unit.c_str());
    as_expected = as_expected && std::abs(found.value - expected) < kFoundTo;
  }
  return as_expected ? 0 : 1;
}
