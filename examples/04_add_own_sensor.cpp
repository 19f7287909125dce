// Your own sensor: a draw-wire encoder with its own scale and zero.
//
// A wire runs from a drum on the table to the gripper.  The encoder reads how much wire is out; the
// true length is reading (1 + scale) + zero.  The sensor computes this; jets differentiate it.
// Its unit test, with kinecal/testing.hpp:  EXPECT_EQ(check_sensor(DrawWire{}), kLawsHold);
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

struct DrawWire {
  static constexpr std::string_view kType = "draw_wire";
  static constexpr std::array kParameters = {ParameterInfo{"scale"}, ParameterInfo{"zero", "m"}};

  template <class S, class Q>
  Reading<S> place(const Measurement<DrawWire, Q>& m, const std::array<S, 2>& v) const {
    return {.value = m.point.x() * (1.0 + v[0]) + v[1]};
  }
};
static_assert(Sensor<DrawWire>);

/// Distance from the drum to the end of the wire, minus the length that the encoder reads.
struct WireLength {
  static constexpr const char *kType = "wire", *kUnit = "m";
  using Inputs = Takes<Quantity::point, Quantity::reading>;

  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base, const Reading<S>& wire) const {
    return Eigen::Matrix<S, 1, 1>((p_base - wire.origin).norm() - wire.value);
  }
};

// The drum is at the robot's base.  (On the axis of the pan joint, so its zero is not free.)
using Robot = mobile_manipulator::Robot;
using Arm = Chain3d<"arm", Chain<Robot, "base_link", "gripper_link">>;
using Wire = SensorOn<"wire", Chain<Robot, "base_link", "base_link">, DrawWire>;
using Measured =
    Crate<Arm, Wire, JointOffset<"shoulder_lift_joint">, JointOffset<"elbow_flex_joint">,
          SensorParameters<"wire", "scale", "zero">, Block<"length", WireLength, "arm", "wire">>;

/// A sample at a random pose; the encoder's noise is 0.2 mm.
Sample measure(const ParameterTable& truth, SeededRandom& random) {
  static const kinecal::Robot robot = Measured::robot();
  Sample sample = random_pose(robot, random);
  const Pose<double> gripper = true_pose(robot, truth, "base_link", "gripper_link", sample);
  const double length = gripper.translation.norm() + 2e-4 * random.normal();
  const double reading = (length - truth["wire_zero"].value) / (1.0 + truth["wire_scale"].value);
  sample.observations = {{"arm", {{"gripper_link", Vector3<double>::Zero()}}},
                         {"wire", {{"base_link", {reading, 0.0, 0.0}}}}};
  return sample;
}

}  // namespace

int main() {
  ParameterTable truth = Measured().table({});
  truth["shoulder_lift_joint"].value = -1.5 * kDegree;
  truth["elbow_flex_joint"].value = 2.0 * kDegree;
  truth["wire_scale"].value = 0.012;
  truth["wire_zero"].value = 0.085;
  SeededRandom random(4);
  std::vector<Sample> samples;
  for (int n = 0; n < 200; ++n) samples.push_back(measure(truth, random));

  const CrateResult<Measured> result = calibrate(Measured(), samples);

  const BlockStatistics& fit = result.blocks.front();
  std::printf("length of the wire: %.3f mm RMS before, %.3f mm after\n", 1e3 * fit.before.rms,
              1e3 * fit.after.rms);
  bool all_found = result.converged && fit.after.rms < 3e-4;
  for (const int i : result.calibrated) {
    const Parameter& found = result.table[i];
    const double expected = truth[found.name].value;
    std::printf("  %-20s true %8.4f  found %8.4f %s\n", found.name.c_str(), expected, found.value,
                found.unit.c_str());
    all_found = all_found && std::abs(found.value - expected) < 1e-3;
  }
  return all_found ? 0 : 1;
}
