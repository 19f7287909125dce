// The blocks of a mobile base: laws, zero at the truth, full turns.
#include "kinecal/errors/base_motion.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kinecal/testing.hpp"

namespace kinecal {
namespace {

static_assert(ErrorBlock<DifferentialToPose> && kSensors<DifferentialToPose> == 0);
static_assert(kResiduals<DifferentialToPose> == 3 && kResiduals<DifferentialToWall> == 2 &&
              kResiduals<GyroToPose> == 1);

using Motion = PlanarMotion<double>;

constexpr double kMotionRounding = 1e-12;

TEST(BaseBlocks, KeepTheLaws) {
  EXPECT_EQ(check_block(DifferentialToPose{}), kLawsHold);
  EXPECT_EQ(check_block(DifferentialToWall{}), kLawsHold);
  EXPECT_EQ(check_block(MecanumToPose{}), kLawsHold);
  EXPECT_EQ(check_block(MecanumToWall{}), kLawsHold);
  EXPECT_EQ(check_block(TricycleToPose{}), kLawsHold);
  EXPECT_EQ(check_block(TricycleToWall{}), kLawsHold);
  EXPECT_EQ(check_block(OdometryToPose{}), kLawsHold);
  EXPECT_EQ(check_block(OdometryToWall{}), kLawsHold);
  EXPECT_EQ(check_block(GyroToPose{}), kLawsHold);
  EXPECT_EQ(check_block(GyroToWall{}), kLawsHold);
}

/// What was seen of the base before and after a motion.
struct Seen {
  Motion before, now;  ///< of the sensor in the world

  [[nodiscard]] std::vector<double> track() const {
    return {now.x, now.y, now.angle(), before.x, before.y, before.angle()};
  }
  /// A wall at x = 4.
  [[nodiscard]] std::vector<double> wall() const {
    return {-now.angle(), 4.0 - now.x, -before.angle(), 4.0 - before.x};
  }
};

/// The residual of a block where the base moved as its drive says.
/// @param at     what the drive takes
/// @param wrong  added to the last parameter of the drive
template <class B>
Eigen::VectorXd residual(const std::vector<double>& at, double wrong = 0.0) {
  B block;
  block.mount = {0.2, -0.1, 2.5};
  auto own = block.initial();
  const std::size_t last = own.size() - 4;
  for (std::size_t i = 0; i < last; ++i) own[i] += 0.03 * static_cast<double>(i) - 0.02;
  const Motion base_T_sensor = Motion::at(0.2, -0.1, 2.5), start = Motion::at(0.5, 0.7, -0.4);
  const Motion moved = block.drive.motion(own.data(), at.data());
  const Seen seen{start * base_T_sensor, start * moved * base_T_sensor};
  own[last] += wrong;
  std::array<double, B::kConditions.size()> conditions{};
  auto next = std::copy(at.begin(), at.end(), conditions.begin());
  const std::vector<double> other = kResiduals<B> == 3 ? seen.track() : seen.wall();
  std::copy(other.begin(), other.end(), next);
  return block(own, conditions);
}

template <class Pose, class Wall>
void expect_zero_at_the_truth(const std::vector<double>& at) {
  EXPECT_LT(residual<Pose>(at).norm(), kMotionRounding);
  EXPECT_LT(residual<Wall>(at).norm(), kMotionRounding);
  EXPECT_GT(residual<Pose>(at, 0.01).norm(), 1e-4);
  EXPECT_GT(residual<Wall>(at, 0.01).norm(), 1e-4);
}

TEST(BaseBlocks, AreZeroAtTheTruth) {
  expect_zero_at_the_truth<DifferentialToPose, DifferentialToWall>({3.4, 5.1, 3.1, 4.2});
  expect_zero_at_the_truth<MecanumToPose, MecanumToWall>({1.2, 0.9, 0.3, -0.2, 0.7, 0.1, 0.4, 0.6});
  expect_zero_at_the_truth<TricycleToPose, TricycleToWall>({3.4, 0.4, 3.1, 0.3});
  expect_zero_at_the_truth<OdometryToPose, OdometryToWall>({3.4, 5.1, 3.1, 3.2, 4.2, 2.8});
}

/// A turn in place by more than a full one: what is seen does not count turns.
TEST(BaseBlocks, TakeFullTurns) {
  const double full = 2.0 * std::numbers::pi + 0.1;
  expect_zero_at_the_truth<DifferentialToPose, DifferentialToWall>({-full, full, 0.0, 0.0});
  expect_zero_at_the_truth<OdometryToPose, OdometryToWall>({0.0, 0.0, full, 0.0, 0.0, 0.0});
  const std::array<double, 2> own{1.02, 0.003};
  const double turned = 1.02 * full + 0.003 * 4.0;
  EXPECT_NEAR(GyroToPose{}(own, std::array{full, 4.0, 0.0, 0.0,
                                           std::remainder(turned, 2.0 * std::numbers::pi), 0.0})(0),
              0.0, kMotionRounding);
  EXPECT_NEAR(
      GyroToWall{}(own, std::array{full, 4.0, 0.0, 0.0,
                                   -std::remainder(turned, 2.0 * std::numbers::pi), 0.0})(0),
      0.0, kMotionRounding);
}

/// The odometry of a base that turns and drives is that of its wheels, to scale.
TEST(BaseBlocks, OdometryToScaleIsThatOfTheWheels) {
  const DifferentialDrive wheels{0.06, 0.4};
  const std::array<double, 4> at{9.0, 17.0, 0.0, 0.0}, nominal{1.0, 1.0, 1.0, 1.0},
      truth{1.03, 0.98, 1.0, 1.0};
  const Motion reported = wheels.motion(nominal.data(), at.data()),
               moved = wheels.motion(truth.data(), at.data());
  const std::array<double, 6> odometry{reported.x, reported.y, reported.angle(), 0.0, 0.0, 0.0};
  const Motion scaled = ReportedOdometry{}.motion(truth.data(), odometry.data());
  EXPECT_NEAR(scaled.x, moved.x, kMotionRounding);
  EXPECT_NEAR(scaled.y, moved.y, kMotionRounding);
  EXPECT_NEAR(scaled.angle(), moved.angle(), kMotionRounding);
}

/// To the left and straight ahead, by hand.
TEST(BaseDrives, MoveAsWheelsDo) {
  const MecanumDrive mecanum{0.05, 0.3, 0.5};
  const std::array<double, 3> own{1.0, 1.0, 1.0};
  const std::array<double, 8> left{-1.0, 1.0, 1.0, -1.0};
  Motion moved = mecanum.motion(own.data(), left.data());
  EXPECT_NEAR(moved.y, 0.05, kMotionRounding);
  EXPECT_NEAR(moved.x, 0.0, kMotionRounding);
  const std::array<double, 8> turn{-1.0, 1.0, -1.0, 1.0};
  moved = mecanum.motion(own.data(), turn.data());
  EXPECT_NEAR(moved.angle(), 0.05 / 0.4, kMotionRounding);
  const TricycleDrive tricycle{0.1, 1.2};
  const std::array<double, 4> steered{1.0, 1.0, 1.0, 0.0};
  const double right_angle = 0.5 * std::numbers::pi;
  const std::array<double, 4> at{3.0, right_angle, 0.0, right_angle};
  moved = tricycle.motion(steered.data(), at.data());  // about the middle of the axle
  EXPECT_NEAR(std::hypot(moved.x, moved.y), 0.0, kMotionRounding);
  EXPECT_NEAR(moved.angle(), 0.3 / 1.2, kMotionRounding);
}

}  // namespace
}  // namespace kinecal
