#include "kinecal/study/joint_motion.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(JointMotion, KeepsItsSpeedAndAccelerationAndArrives) {
  JointDrive drive;
  drive.swing = 0.0;
  for (const double to : {0.01, 0.4, 3.0, -2.0}) {
    for (const double factor : {1.0, 0.3}) {
      const JointMotion motion(0.5, to, drive, factor);
      constexpr double kStep = 1e-3;
      double before = motion.position(0.0), speed = 0.0;
      EXPECT_EQ(before, 0.5);
      for (double t = kStep; t < motion.arrival() + 1.0; t += kStep) {
        const double now = motion.position(t), moved = (now - before) / kStep;
        EXPECT_LE(std::abs(moved), drive.speed * factor + 1e-9);
        EXPECT_LE(std::abs(moved - speed), drive.acceleration * kStep * 1.001 + 1e-9);
        before = now;
        speed = moved;
      }
      EXPECT_EQ(motion.position(motion.rest()), to);
    }
  }
  const double time = 2.0 / 1.0 + 1.0 / 2.0;  // 2 rad at 1 rad/s, and 0.5 s to reach it
  EXPECT_NEAR(JointMotion(0.0, 2.0, drive).arrival(), time, 1e-12);
}

TEST(JointMotion, SwingsAfterItsArrivalAndComesToRest) {
  const JointMotion motion(0.0, 1.0, {});
  double most = 0.0;
  for (double t = motion.arrival(); t < motion.arrival() + 0.2; t += 1e-3) {
    most = std::max(most, std::abs(motion.position(t) - 1.0));
  }
  EXPECT_GT(most, 0.001);
  EXPECT_EQ(motion.position(motion.rest() + 0.01), 1.0);
}

TEST(JointMotion, DoesNotMoveWithoutADistance) {
  const JointMotion motion(0.3, 0.3, {});
  EXPECT_EQ(motion.rest(), 0.0);
  EXPECT_EQ(motion.direction(), 0);
  EXPECT_EQ(motion.position(1.0), 0.3);
}

}  // namespace
}  // namespace kinecal
