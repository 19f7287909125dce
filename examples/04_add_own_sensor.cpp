// Your own sensor: a draw-wire encoder.
//
// A wire runs from an eyelet on the table to the gripper.  The encoder on its drum reads how much
// wire is out, from an unknown zero.  A reading is a length; we record it as a point with that x,
// in a virtual frame whose own x is the zero.  The error block interprets it.  (Only cameras have
// parameters of their own.  A virtual frame can shift or rotate a reading, but not scale it.)
// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "kinecal/errors/error_block.hpp"
#include "kinecal/solve.hpp"
#include "robots/mobile_manipulator.hpp"
#include "true_robot.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

const Vector3<double> kEyelet(0.9, 0.3, 0.2);  // metres, in base_link

/// Distance from the eyelet to the end of the wire, minus the length that the encoder reads.
struct WireLength {
  static constexpr const char *kType = "wire", *kUnit = "m";

  /// @param p_base   (3) end of the wire, metres, in the base
  /// @param reading  (3) x: length of the wire, metres
  template <class S>
  Eigen::Matrix<S, 1, 1> operator()(const Vector3<S>& p_base, const Vector3<S>& reading) const {
    const Vector3<S> wire = p_base - kEyelet.cast<S>();
    return Eigen::Matrix<S, 1, 1>(sqrt(wire.squaredNorm()) - reading.x());
  }
};
static_assert(PointPairBlock<WireLength>);

using Arm = Chain3d<"arm", Chain<mobile_manipulator::Robot, "base_link", "gripper_link">>;
using Wire = Chain3d<"wire", Chain<mobile_manipulator::Robot, "base_link", "base_link">>;
using Pan = JointOffset<"shoulder_pan_joint">;
using Lift = JointOffset<"shoulder_lift_joint">;
using Elbow = JointOffset<"elbow_flex_joint">;
using Zero = VirtualFrame<"wire_zero", Axes{.x = true}>;  // wire that is out at reading 0
using Measured =
    Crate<Arm, Wire, Pan, Lift, Elbow, Zero, Block<"length", WireLength, "arm", "wire">>;

/// A sample at a random pose; the encoder's noise is 0.2 mm.
Sample measure(const ParameterTable& truth, SeededRandom& random) {
  static const Robot robot = Measured::robot();
  Sample sample = random_pose(robot, random);
  const Pose<double> gripper = true_pose(robot, truth, "base_link", "gripper_link", sample);
  const double length = (gripper.translation - kEyelet).norm();
  const double reading = length - truth["wire_zero_x"].value + 2e-4 * random.normal();
  sample.observations = {{"arm", {{"gripper_link", Vector3<double>::Zero()}}},
                         {"wire", {{"wire_zero", {reading, 0.0, 0.0}}}}};
  return sample;
}

}  // namespace

int main() {
  ParameterTable truth = Measured::table({});
  truth["shoulder_pan_joint"].value = 1.0 * kDegree;
  truth["shoulder_lift_joint"].value = -1.5 * kDegree;
  truth["elbow_flex_joint"].value = 2.0 * kDegree;
  truth["wire_zero_x"].value = 0.085;
  SeededRandom random(4);
  std::vector<Sample> samples;
  for (int n = 0; n < 60; ++n) samples.push_back(measure(truth, random));

  const CrateResult<Measured> result = calibrate(Measured(), samples);

  const BlockStatistics& fit = result.blocks.front();
  std::printf("length of the wire: %.3f mm RMS before, %.3f mm after\n", 1e3 * fit.before.rms,
              1e3 * fit.after.rms);
  bool all_found = result.converged && fit.after.rms < 3e-4;
  for (const int i : result.calibrated) {
    const Parameter& found = result.table[i];
    const double expected = truth[found.name].value, unit = found.unit == "m" ? 1e-3 : kDegree;
    std::printf("  %-20s true %7.3f  found %7.3f %s\n", found.name.c_str(), expected / unit,
                found.value / unit, found.unit == "m" ? "mm" : "degrees");
    // 0.2 mm of noise, averaged over 60 samples: some 0.1 mrad and 0.1 mm.
    all_found = all_found && std::abs(found.value - expected) < 5e-4;
  }
  return all_found ? 0 : 1;
}
