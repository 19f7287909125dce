// Forward kinematics inside your own Ceres problem.
//
// A telescoping ball bar reads the distance from a ball on the table to the gripper.  The position
// of the ball is unknown.  forward_kinematics() takes any scalar, so ceres::AutoDiffCostFunction
// differentiates it: your residuals, parameter blocks and Ceres options stay as they are.
// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <cstdio>

#include "kinecal/kinematics/forward_kinematics.hpp"
#include "robots/mobile_manipulator.hpp"
#include "simulation.hpp"

namespace {

using namespace kinecal;
using namespace kinecal::examples;

using Arm = Chain<mobile_manipulator::Robot, "torso_lift_link", "gripper_link">;
constexpr int kJoints = Arm::kSize;
using Positions = Eigen::Matrix<double, kJoints, 1>;  // radians, in the order of joint_names(Arm{})

/// Distance of ball and gripper minus the length that the bar reads.
struct BallBar {
  Positions q;    ///< measured positions
  double length;  ///< metres

  /// @param zeros  (kJoints) added to the measured positions, radians
  /// @param ball   (3) metres, in torso_lift_link
  template <class S>
  bool operator()(const S* zeros, const S* ball, S* residual) const {
    using Joints = Eigen::Matrix<S, kJoints, 1>;
    const Joints moved = q.cast<S>() + Eigen::Map<const Joints>(zeros);
    const Vector3<S> bar =
        forward_kinematics(Arm{}, moved).translation - Eigen::Map<const Vector3<S>>(ball);
    residual[0] = bar.norm() - length;
    return true;
  }
};

}  // namespace

int main() {
  Positions truth;
  truth << 0.0, 1.2, -0.8, 1.5, -1.0, 0.7, 0.0;  // degrees
  truth *= kDegree;
  const Vector3<double> true_ball(0.7, 0.2, -0.1);

  ceres::Problem problem;
  Positions zeros = Positions::Zero();
  Vector3<double> ball(0.6, 0.0, 0.0);  // a guess
  SeededRandom random(9);
  for (int n = 0; n < 120; ++n) {
    const Positions q = Positions::NullaryExpr([&] { return random.uniform(-1.2, 1.2); });
    double length = 0.0;
    BallBar{q, 0.0}(truth.data(), true_ball.data(), &length);
    length += 5e-5 * random.normal();  // 0.05 mm
    using Cost = ceres::AutoDiffCostFunction<BallBar, 1, kJoints, 3>;
    problem.AddResidualBlock(new Cost(new BallBar{q, length}), nullptr, zeros.data(), ball.data());
  }
  // A zero of the first joint turns with the ball, and the last one turns about the gripper's axis:
  // distances determine neither.
  problem.SetManifold(zeros.data(), new ceres::SubsetManifold(kJoints, {0, kJoints - 1}));

  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.function_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);

  std::printf("%s\n\n", summary.BriefReport().c_str());
  const auto names = joint_names(Arm{});
  for (int i = 0; i < kJoints; ++i) {
    std::printf("  %-20s true %6.3f  found %6.3f degrees\n",
                names[static_cast<std::size_t>(i)].c_str(), truth(i) / kDegree, zeros(i) / kDegree);
  }
  std::printf("  %-20s %.2f mm off\n", "ball", 1e3 * (ball - true_ball).norm());
  // 0.05 mm of noise at 0.3 m and more, averaged over 120 readings.
  const bool found =
      (zeros - truth).cwiseAbs().maxCoeff() < 5e-4 && (ball - true_ball).norm() < 3e-4;
  return summary.IsSolutionUsable() && found ? 0 : 1;
}
