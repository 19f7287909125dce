#include "kinecal/errors/loss.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <vector>

namespace kinecal {
namespace {

constexpr std::array kAll = {LossType::none, LossType::huber, LossType::cauchy, LossType::tukey};

/// Squared residuals: none, tiny, around the scale (exactly there, a step beside it), large.
std::vector<double> squares_around(double scale) {
  const double c2 = scale * scale;
  std::vector<double> squares = {
      0.0,    1e-300,  1e-20,    1e-8 * c2, 0.5 * c2, c2 * (1 - 1e-15), c2, c2 * (1 + 1e-15),
      2 * c2, 10 * c2, 1e6 * c2, 1e30 * c2, 1e100};
  for (double s = 0.03; s < 3.0; s *= 1.17) squares.push_back(s * c2);
  return squares;
}

/// In the words of the header, with branches.
double expected_rho(LossType type, double c, double s) {
  const double c2 = c * c;
  if (type == LossType::huber) return s <= c2 ? s : 2 * c * std::sqrt(s) - c2;
  if (type == LossType::cauchy) return c2 * std::log1p(s / c2);
  if (type == LossType::tukey) return s <= c2 ? c2 / 3 * (1 - std::pow(1 - s / c2, 3)) : c2 / 3;
  return s;
}

TEST(Loss, IsItsFormula) {
  constexpr double kRounding = 1e-14;
  for (const LossType type : kAll) {
    for (const double scale : {0.007, 1.0, 30.0}) {
      for (const double s : squares_around(scale)) {
        const double expected = expected_rho(type, scale, s);
        EXPECT_NEAR(Loss({type, scale})(s).rho, expected, kRounding * (scale * scale + expected))
            << static_cast<int>(type) << " at " << s;
      }
    }
  }
}

TEST(Loss, IsZeroAtZeroWithSlopeOne) {
  for (const LossType type : kAll) {
    EXPECT_EQ(Loss({type, 0.7})(0.0).rho, 0.0);
    EXPECT_EQ(Loss({type, 0.7})(0.0).derivative, 1.0);
  }
}

TEST(Loss, HasTheDerivativeItSays) {
  for (const LossType type : kAll) {
    const Loss loss{type, 0.7};
    for (double s = 0.01; s < 2.0; s += 0.0371) {
      constexpr double kStep = 1e-6, kDifferences = 1e-6;  // also at the kink of rho'
      const double numeric = (loss(s + kStep).rho - loss(s - kStep).rho) / (2 * kStep);
      EXPECT_NEAR(loss(s).derivative, numeric, kDifferences) << static_cast<int>(type) << " " << s;
    }
  }
}

/// rho' s <= rho, on which the compressed cost relies; 0 <= rho' <= 1.
TEST(Loss, BoundsItsTangent) {
  for (const LossType type : kAll) {
    for (const double scale : {0.007, 1.0, 30.0}) {
      for (const double s : squares_around(scale)) {
        const auto value = Loss{type, scale}(s);
        constexpr double kRounding = 1e-15;
        EXPECT_LE(value.derivative * s, value.rho + kRounding * scale * scale);
        EXPECT_GE(value.derivative, 0.0);
        EXPECT_LE(value.derivative, 1.0);
      }
    }
  }
}

/// Far below the scale a loss is the square itself, to all its digits: near the minimum of exact
/// samples a cost of fewer looks as if it no longer fell.
TEST(Loss, KeepsItsDigitsWhereTheResidualIsSmall) {
  for (const LossType type : kAll) {
    for (const double ratio : {1e-4, 1e-8, 1e-12, 1e-20}) {
      constexpr double kRounding = 1e-15, kScale = 0.3;
      const double s = ratio * kScale * kScale;
      // s - s^2 / (2 c^2) + ... for cauchy, s - s^2 / c^2 + ... for tukey
      const double second = type == LossType::cauchy ? 0.5 : type == LossType::tukey ? 1.0 : 0.0;
      const double third = second * second * ratio * ratio / 3.0 * (second == 0.5 ? 4.0 : 1.0);
      const double expected = s * (1.0 - second * ratio + third);
      EXPECT_NEAR(Loss({type, kScale})(s).rho, expected,
                  (4 * kRounding + ratio * ratio * ratio) * s)
          << static_cast<int>(type) << " at " << ratio << " of its scale, squared";
    }
  }
}

/// One value in each lane: both branches of a loss in one packet.
TEST(Loss, OfAPacketIsThatOfEachLane) {
  for (const LossType type : kAll) {
    for (const double scale : {0.007, 1.0, 30.0}) {
      const Loss loss{type, scale};
      const std::vector<double> squares = squares_around(scale);
      for (std::size_t first = 0; first < squares.size(); ++first) {
        for (const std::size_t stride : {1u, 5u}) {
          const auto in_lane = [&](int i) {
            return squares[(first + stride * static_cast<std::size_t>(i)) % squares.size()];
          };
          Packet s(0.0);
          for (int i = 0; i < kLanes<Packet>; ++i) set_lane(s, i, in_lane(i));
          const auto found = loss(s);
          for (int i = 0; i < kLanes<Packet>; ++i) {
            const auto expected = loss(in_lane(i));
            constexpr double kRounding = 1e-15;  // a logarithm of another library
            EXPECT_NEAR(lane(found.rho, i), expected.rho, 4 * kRounding * expected.rho)
                << static_cast<int>(type) << " at " << in_lane(i);
            EXPECT_NEAR(lane(found.derivative, i), expected.derivative, kRounding);
          }
        }
      }
    }
  }
}

TEST(Loss, OfNaNIsNaN) {
  for (const LossType type : kAll) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(std::isnan(Loss({type, 1.0})(nan).rho)) << static_cast<int>(type);
    Packet s(0.5);
    set_lane(s, kLanes<Packet> - 1, nan);
    const auto value = Loss({type, 1.0})(s);
    EXPECT_TRUE(std::isnan(lane(value.rho, kLanes<Packet> - 1))) << static_cast<int>(type);
    if (kLanes < Packet >> 1) {
      EXPECT_TRUE(std::isfinite(lane(value.rho, 0)));
    }
  }
}

TEST(Loss, IsReplacedByHuberWhereItIsNotConvex) {
  for (const LossType type : kAll) {
    const Loss convex = Loss{type, 0.3}.convex();
    EXPECT_TRUE(convex.is_convex());
    EXPECT_EQ(convex.scale, 0.3);
    EXPECT_EQ(convex.type, type == LossType::none ? LossType::none : LossType::huber);
  }
  EXPECT_FALSE((Loss{LossType::cauchy, 1.0}.is_convex()));
  EXPECT_FALSE((Loss{LossType::tukey, 1.0}.is_convex()));
}

}  // namespace
}  // namespace kinecal
