#include "kinecal/kinematics/forward_kinematics.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <unsupported/Eigen/AutoDiff>

#include "kinecal/geometry/jet.hpp"
#include "support/static_robot.hpp"

namespace kinecal {
namespace {

using Arm = Chain<test::StaticRobot, "base", "tip">;
constexpr auto kSize = static_cast<int>(Arm::kSize);
using ScalarPositions = Eigen::Matrix<double, kSize, 1>;
using Dual = Eigen::AutoDiffScalar<ScalarPositions>;
using DynamicDual = Eigen::AutoDiffScalar<Eigen::VectorXd>;

static_assert(Scalar<double> && Scalar<float> && Scalar<long double> && Scalar<Packet>);
static_assert(Scalar<Jet<double, 3>> && Scalar<Jet<Packet, 3>> && Scalar<std::complex<double>>);
static_assert(Scalar<Dual> && Scalar<DynamicDual>);
static_assert(!Scalar<int> && !Scalar<bool> && !Scalar<std::string> && !Scalar<ScalarPositions>);
static_assert(std::same_as<Product<double, float>, float> &&
              std::same_as<Product<Dual, double>, Dual>);

ScalarPositions some_positions() {
  return ScalarPositions::LinSpaced(-0.4, 0.7);
}

RuntimeChain at_run_time() {
  return make_chain(robot_from<test::StaticRobot>(), "base", "tip");
}

TEST(ForwardKinematics, InFloatAgreesWithDouble) {
  const ScalarPositions q = some_positions();
  const Eigen::Matrix<float, kSize, 1> rounded = q.cast<float>();
  const Pose<double> expected = forward_kinematics(Arm{}, q);
  const auto jacobian = geometric_jacobian(Arm{}, q);
  constexpr double kOfFloat = 1e-6;  // ten roundings
  for (const Pose<float>& tip :
       {forward_kinematics(Arm{}, rounded), forward_kinematics(at_run_time(), rounded)}) {
    EXPECT_TRUE(tip.translation.cast<double>().isApprox(expected.translation, kOfFloat));
    EXPECT_TRUE(tip.rotation.cast<double>().isApprox(expected.rotation, kOfFloat));
  }
  EXPECT_TRUE(geometric_jacobian(Arm{}, rounded).cast<double>().isApprox(jacobian, kOfFloat));
  Corrections<float> corrections(Arm::kSize);
  for (auto& correction : corrections) {
    correction.offset = make_joint_state(0.01f);
    correction.set_frame({0.01f, 0.02f, 0.03f}, {0.1f, 0.2f, 0.3f});
  }
  Corrections<double> in_double(Arm::kSize);
  for (auto& correction : in_double) {
    correction.offset = make_joint_state(0.01);
    correction.set_frame({0.01, 0.02, 0.03}, {0.1, 0.2, 0.3});
  }
  EXPECT_TRUE(forward_kinematics(at_run_time(), rounded, corrections)
                  .translation.cast<double>()
                  .isApprox(forward_kinematics(at_run_time(), q, in_double).translation, kOfFloat));
}

/// Compares derivatives of the tip by an automatic scalar with the geometric Jacobian.
template <class S>
void expect_derivatives() {
  const ScalarPositions q = some_positions();
  Eigen::Matrix<S, kSize, 1> variables;
  for (int i = 0; i < kSize; ++i) {
    variables(i) = S(q(i));
    variables(i).derivatives() = ScalarPositions::Unit(i);
  }
  const auto jacobian = geometric_jacobian(Arm{}, q);
  for (const Pose<S>& tip :
       {forward_kinematics(Arm{}, variables), forward_kinematics(at_run_time(), variables)}) {
    for (int k = 0; k < 3; ++k) {
      const ScalarPositions found = tip.translation(k).derivatives();
      EXPECT_LT((found.transpose() - jacobian.row(k)).norm(), 1e-14) << "row " << k;
    }
  }
}

TEST(ForwardKinematics, IsDifferentiatedByEigensOwnScalars) {
  expect_derivatives<Dual>();
  expect_derivatives<DynamicDual>();
}

}  // namespace
}  // namespace kinecal
