#include "kinecal/capture/finders/wall_in_scan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace kinecal {
namespace {

using testing::HasSubstr;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kFar = std::numeric_limits<double>::infinity();

/// A scan of half a turn, by half a degree.
struct Scan {
  std::vector<double> ranges = std::vector<double>(361, kFar);

  [[nodiscard]] static double angle(std::size_t i) {
    return (static_cast<double>(i) - 180.0) * std::numbers::pi / 360.0;
  }
  /// A wall, with noise.
  void add_wall(double direction, double distance, double noise) {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      const double ahead = std::cos(angle(i) - direction);
      if (ahead > 0.1) ranges[i] = distance / ahead + noise * normal(random);
    }
  }
  [[nodiscard]] FoundWall found(const WallWindow& window = {}) const {
    return wall_in_scan({ranges, angle(0), angle(1) - angle(0), 0.05, 30.0}, window);
  }
};

TEST(WallInScan, IsFoundWithNoise) {
  // 115 ranges within 0.5 rad, with 5 mm: the distance is known to 0.5 mm, the angle to 0.6 mrad.  Five times as much is
  // allowed; the scatter is known to a fifteenth of itself.
  for (const double direction : {0.0, 0.3, -0.4}) {
    Scan scan;
    scan.add_wall(direction, 2.5, 0.005);
    const FoundWall found = scan.found();
    ASSERT_TRUE(found.wall) << found.refusal;
    EXPECT_NEAR(found.wall->angle, direction, 0.003);
    EXPECT_NEAR(found.wall->distance, 2.5, 0.003);
    EXPECT_NEAR(found.wall->scatter, 0.005, 0.002);
  }
}

/// A scanner that counts its angles from 0 to a full turn sees the same.
TEST(WallInScan, IsFoundWhereAnglesAreOfAFullTurn) {
  constexpr double kStep = std::numbers::pi / 360.0;
  std::vector<double> ranges(720, kFar);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double ahead = std::cos(kStep * static_cast<double>(i));
    if (ahead > 0.1) ranges[i] = 2.5 / ahead;
  }
  const FoundWall found = wall_in_scan({ranges, 0.0, kStep, 0.05, 30.0});
  ASSERT_TRUE(found.wall) << found.refusal;
  EXPECT_NEAR(found.wall->angle, 0.0, 1e-6);
  EXPECT_EQ(found.wall->points, 115) << "of both sides: 57 to either, and the one ahead";
}

/// What stands before it, what is behind a door, what was not measured.
TEST(WallInScan, IsFoundBehindOtherThings) {
  Scan scan;
  scan.add_wall(0.1, 2.0, 0.003);
  for (std::size_t i = 150; i < 180; ++i) scan.ranges[i] = 1.2;
  for (std::size_t i = 200; i < 210; ++i) scan.ranges[i] = 5.0;
  for (std::size_t i = 140; i < 240; i += 9) scan.ranges[i] = kNone;
  for (std::size_t i = 141; i < 240; i += 11) scan.ranges[i] = kFar;
  for (std::size_t i = 142; i < 240; i += 13) scan.ranges[i] = 0.0;
  const FoundWall found = scan.found();
  ASSERT_TRUE(found.wall) << found.refusal;
  EXPECT_NEAR(found.wall->angle, 0.1, 0.003);
  EXPECT_NEAR(found.wall->distance, 2.0, 0.003);
}

TEST(WallInScan, RefusesAScanWithoutAWall) {
  Scan scan;
  EXPECT_THAT(scan.found().refusal, HasSubstr("0 ranges between -0.50 and 0.50 rad are numbers"));
  for (std::size_t i = 0; i < scan.ranges.size(); ++i) {  // a heap of boxes
    scan.ranges[i] = 1.5 + 0.3 * std::sin(1.7 * static_cast<double>(i * i % 31));
  }
  EXPECT_THAT(scan.found().refusal, HasSubstr("points are on one line"));
  Scan round;  // a column around which it stands: no line
  for (double& range : round.ranges) range = 1.0;
  EXPECT_THAT(round.found().refusal, HasSubstr("the middle stands out"));
  Scan narrow;
  narrow.add_wall(0.0, 2.0, 0.01);
  EXPECT_THAT(narrow.found({.min_angle = -0.06, .max_angle = 0.06}).refusal,
              HasSubstr("its angle is known to"));
}

}  // namespace
}  // namespace kinecal
