#include "kinecal/geometry/sin_cos.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace kinecal {
namespace {

/// Expects sine and cosine as the C library has them, to two units in the last place of a number near one.
void expect_as_of_library(double angle) {
  constexpr double kTwoUnits = 2.0 * std::numeric_limits<double>::epsilon();
  Packet packet(0.25);
  packet.set(Packet::size() - 1, angle);
  const SinCos<Packet> found = sin_cos(packet);
  EXPECT_NEAR(found.sin[Packet::size() - 1], std::sin(angle), kTwoUnits) << angle;
  EXPECT_NEAR(found.cos[Packet::size() - 1], std::cos(angle), kTwoUnits) << angle;
  EXPECT_NEAR(found.sin[0], std::sin(0.25), kTwoUnits) << "beside " << angle;
}

TEST(SinCos, AreThoseOfTheCLibrary) {
  std::mt19937 random(3);
  for (const double below : {1e-8, 1.0, 7.0, 100.0, 1e5, 1e9}) {
    std::uniform_real_distribution<double> angle(-below, below);
    for (int i = 0; i < 2000; ++i) expect_as_of_library(angle(random));
  }
  for (int quarters = -40; quarters <= 40; ++quarters) {
    const double angle = quarters * std::acos(0.0);
    for (const double near : {angle, std::nextafter(angle, 1e9), std::nextafter(angle, -1e9)}) {
      expect_as_of_library(near);
    }
  }
}

TEST(SinCos, OfASmallAngleIsTheAngle) {
  for (const double angle : {0.0, 1e-300, -1e-20, 3e-9}) {
    EXPECT_EQ(sin_cos(Packet(angle)).sin[0], angle);
    EXPECT_EQ(sin_cos(Packet(angle)).cos[0], 1.0);
  }
}

TEST(SinCos, OfWhatIsNoAngleIsNoNumber) {
  for (const double angle :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_TRUE(std::isnan(sin_cos(Packet(angle)).sin[0]));
    EXPECT_TRUE(std::isnan(sin_cos(Packet(angle)).cos[0]));
  }
}

}  // namespace
}  // namespace kinecal
