// Motions in the plane against small steps.
#include "kinecal/geometry/planar_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace kinecal {
namespace {

using Motion = PlanarMotion<double>;

constexpr double kOfRounding = 1e-12;

TEST(PlanarMotions, ArcsAreTheLimitOfSmallSteps) {
  constexpr int kSteps = 100'000;
  constexpr double kOfSteps = 1e-9;  // error of midpoint steps
  for (const double turn : {0.0, 1e-8, 1e-3, 0.7, -2.0, 3.1, 2.0 * std::numbers::pi, -7.0}) {
    Motion steps;
    for (int n = 0; n < kSteps; ++n) {
      const double half = 0.5 * turn / kSteps, ahead = 0.4 / kSteps, left = -0.1 / kSteps;
      steps = steps * Motion::at(std::cos(half) * ahead - std::sin(half) * left,
                                 std::sin(half) * ahead + std::cos(half) * left, 2.0 * half);
    }
    const Motion arc = planar_exp(0.4, -0.1, turn);
    EXPECT_NEAR(arc.x, steps.x, kOfSteps) << turn;
    EXPECT_NEAR(arc.y, steps.y, kOfSteps) << turn;
    EXPECT_NEAR(arc.sine, steps.sine, kOfSteps) << turn;
    EXPECT_NEAR(arc.cosine, steps.cosine, kOfSteps) << turn;
    if (std::abs(turn) > std::numbers::pi) continue;
    const Vector3<double> back = planar_log(arc);
    EXPECT_TRUE(back.isApprox(Vector3<double>(0.4, -0.1, turn), kOfRounding)) << back.transpose();
  }
}

TEST(PlanarMotions, TheInverseUndoesThem) {
  const Motion motion = Motion::at(0.3, -0.8, 2.4), back = motion * motion.inverse();
  EXPECT_NEAR(back.x, 0.0, kOfRounding);
  EXPECT_NEAR(back.y, 0.0, kOfRounding);
  EXPECT_NEAR(back.angle(), 0.0, kOfRounding);
}

}  // namespace
}  // namespace kinecal
