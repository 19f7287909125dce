// A bad capture and a wrong belief: robust losses and bounds.
//
// In one of 30 samples the arm was still swinging, and the tracker is 5 cm off.  With squares this
// sample pulls the zeros away.  With huber it pulls at most as hard as a point at the loss's scale,
// and cauchy nearly ignores it.  Bounds state what you believe about a parameter.  If it ends at
// its bound, the belief is wrong, or something else is.
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors.hpp"
#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

using Arm = Chain3d<"arm", Chain<mobile_manipulator::Robot, "base_link", "gripper_link">>;
using Tracker = Chain3d<"tracker", Chain<mobile_manipulator::Robot, "base_link", "base_link">>;
using Tracked = Crate<Arm, Tracker, JointOffset<"shoulder_lift_joint">,
                      JointOffset<"elbow_flex_joint">, FrameOffset<"gripper_axis", Axes::xyz>,
                      Block<"tracking", PointToPoint, "arm", "tracker">>;

constexpr double kSigma = 1e-4;  // of the tracker, metres

Sample measure(const ParameterTable& truth, SeededRandom& random) {
  static const Robot robot = Tracked::robot();
  Sample sample = random_pose(robot, random);
  const Pose<double> gripper = true_pose(robot, truth, "base_link", "gripper_link", sample);
  const Vector3<double> seen = gripper.translation + kSigma * random.normal_vector();
  sample.observations = {{"arm", {{"gripper_link", Vector3<double>::Zero()}}},
                         {"tracker", {{"base_link", seen}}}};
  return sample;
}

/// Calibrates with a loss, whose scale is in sigmas, and with bounds on the gripper's length.
/// @returns  the table with the resulting values
ParameterTable calibrate_with(const Loss& loss, double bound, const std::vector<Sample>& samples) {
  Tracked crate;
  crate.block<"tracking">().options.sigma = kSigma;
  crate.block<"tracking">().options.loss = loss;
  ParameterTable table = Tracked().table(samples);
  table["gripper_axis_x"].lower = -bound;
  table["gripper_axis_x"].upper = bound;
  const CrateResult<Tracked> result = calibrate(crate, table, samples);
  if (!result.converged) throw std::runtime_error(result.termination);
  return result.table;
}

}  // namespace

int main() {
  ParameterTable truth = Tracked().table({});
  truth["shoulder_lift_joint"].value = -2.0 * kDegree;
  truth["elbow_flex_joint"].value = 1.5 * kDegree;
  truth["gripper_axis_x"].value = 0.004;
  SeededRandom random(6);
  std::vector<Sample> samples;
  for (int n = 0; n < 30; ++n) samples.push_back(measure(truth, random));
  samples[10].observations[1].features[0].point += 0.05 * random.direction();

  const auto report = [&](const char* name, const Loss& loss, double bound) {
    const ParameterTable found = calibrate_with(loss, bound, samples);
    const double elbow = found["elbow_flex_joint"].value - truth["elbow_flex_joint"].value;
    const double length = found["gripper_axis_x"].value;
    std::printf("%-20s %17.4f %16.3f %s\n", name, elbow / kDegree, 1e3 * length,
                std::abs(length) >= bound ? " at its bound" : "");
    return std::pair(std::abs(elbow), length);
  };
  constexpr double kAnything = 1.0;  // metres
  std::printf("%-20s %17s %16s\n", "", "elbow, degrees off", "length, mm (4)");
  const double squares = report("squares", {}, kAnything).first;
  const double huber = report("huber", {LossType::huber, 3.0}, kAnything).first;
  const double cauchy = report("cauchy", {LossType::cauchy, 3.0}, kAnything).first;
  const double held = report("cauchy, within 1 mm", {LossType::cauchy, 3.0}, 0.001).second;
  const bool robust = huber < 0.2 * squares && cauchy < 0.1 * squares;
  return robust && held == 0.001 ? 0 : 1;
}
