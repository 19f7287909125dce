#include "kinecal/trust/verify/drift_over_time.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kinecal {
namespace {

constexpr double kDay = 86'400.0, kWeek = 7.0 * kDay, kDegree = 0.017453292519943295;

/// Nightly changes of one parameter, with noise of a recording and an error of the calibration that all share.
struct Nights {
  int count = 100;
  double slope = 0.0;         ///< radians a week
  double noise = 5e-4;        ///< radians, of a recording
  double calibration = 2e-4;  ///< radians, shared
  double memory = 0.0;        ///< correlation of the noise of consecutive nights

  [[nodiscard]] std::vector<TimedChange> draw(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    const double shared = calibration * normal(random);
    double error = normal(random);
    std::vector<TimedChange> all;
    for (int i = 0; i < count; ++i) {
      const double time = 1.7e9 + kDay * i;
      all.push_back({time,
                     {shared + noise * error + slope * kDay * i / kWeek},
                     {noise * noise + calibration * calibration},
                     1.0 + 2.0});
      error = memory * error + std::sqrt(1.0 - memory * memory) * normal(random);
    }
    return all;
  }
};

/// The share of lines whose slope differs from the truth by more than 1.96 of its +-.
double beyond(const Nights& nights, int lines) {
  std::mt19937 random(3);
  int count = 0;
  for (int i = 0; i < lines; ++i) {
    const auto line = drift_line(nights.draw(random));
    const double off = line->slope[0] - nights.slope / kWeek;
    count += std::abs(off) > 1.96 * line->slope_deviation(0) ? 1 : 0;
  }
  return static_cast<double>(count) / lines;
}

TEST(DriftOverTime, HasADeviationThatCovers95Percent) {
  constexpr int kLines = 400;
  const double chance = 3.3 * std::sqrt(0.05 * 0.95 / kLines);  // standard deviations of a share
  EXPECT_NEAR(beyond({.slope = 0.05 * kDegree}, kLines), 0.05, chance);
  EXPECT_NEAR(beyond({.slope = 0.05 * kDegree, .calibration = 2e-3}, kLines), 0.05, chance);
  // The correlation itself is known to 1 / sqrt(100) only: twice the chance.
  EXPECT_LT(beyond({.slope = 0.05 * kDegree, .memory = 0.5}, kLines), 0.05 + 2.0 * chance)
      << "0.27 without memory";
}

TEST(DriftOverTime, FindsTheOneOfFiftyRobotsThatDriftsAndNoOther) {
  constexpr int kRobots = 50, kMovers = 8, kFleets = 2;
  std::mt19937 random(11);
  for (int fleet = 0; fleet < kFleets; ++fleet) {
    std::vector<MoverLine> lines;
    for (int robot = 0; robot < kRobots; ++robot) {
      for (int mover = 0; mover < kMovers; ++mover) {
        const bool drifts = robot == 17 && mover == 3 && fleet > 0;
        const Nights nights{.slope = drifts ? 0.05 * kDegree : 0.0};
        std::vector<TimedChange> changes = nights.draw(random);
        for (TimedChange& of : changes) {  // others leave the drift in X
          const double left = kDay * static_cast<double>(&of - changes.data()) / kWeek * 0.05 *
                              kDegree / nights.noise;
          if (robot == 17 && !drifts && fleet > 0) of.score += left * left;
        }
        lines.push_back({robot, mover, *drift_line(changes)});
      }
    }
    const std::vector<DriftingRobot> found = drifting_robots(lines, 0.01);
    if (fleet == 0) {
      EXPECT_TRUE(found.empty());
      continue;
    }
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].robot, 17);
    EXPECT_EQ(found[0].mover, 3);
    EXPECT_TRUE(found[0].alike.empty());
    EXPECT_LT(found[0].probability, 1e-6);
  }
}

/// A zero that wanders, as by temperature, seldom looks like a drift.
TEST(DriftOverTime, SeldomTakesAWanderingZeroForADrift) {
  for (const int nights : {6, 12, 30}) {
    std::mt19937 random(9);
    int alarms = 0;
    constexpr int kLines = 400;
    for (int i = 0; i < kLines; ++i) {
      const auto line = drift_line(Nights{.count = nights, .memory = 0.5}.draw(random));
      alarms += line->probability < 0.01 ? 1 : 0;
    }
    EXPECT_LE(alarms, 10) << nights << " nights: 4 +- 2 are expected of a test at one per cent";
  }
}

TEST(DriftOverTime, FindsAFrameThatSlidesAlongWhatRecordingsDetermine) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<TimedChange> changes;
  for (int i = 0; i < 40; ++i) {  // z is in no recording, x and y are
    const double week = i / 7.0;
    changes.push_back({kWeek * week,
                       {1e-4 * week + 1e-4 * normal(random), 1e-4 * normal(random), 0.0},
                       {1e-8, 0, 0, 0, 1e-8, 0, 0, 0, 0},
                       0.0});
  }
  const auto line = drift_line(changes);
  ASSERT_TRUE(line);
  EXPECT_NEAR(kWeek * line->slope[0], 1e-4, 4.0 * kWeek * line->slope_deviation(0));
  EXPECT_LT(std::abs(line->slope[1]), 4.0 * line->slope_deviation(1));
  EXPECT_EQ(line->slope[2], 0.0);
  EXPECT_LT(line->probability, 1e-5);
  EXPECT_NEAR(line->scatter, 1.0, 3.0 / std::sqrt(2.0 * 76.0)) << "of 80 numbers less four";
}

TEST(DriftOverTime, SaysWhenALimitIsPassed) {
  DriftLine line{.origin = 0.0,
                 .last = 10.0,
                 .recordings = 9,
                 .level = {1e-3},
                 .slope = {1e-4},
                 .covariance = {1e-10, 0, 0, 1e-12}};
  const ChangeSize size{{0.25}};  // half a metre
  EXPECT_DOUBLE_EQ(size.of(std::vector<double>{2e-3}), 1e-3);
  const auto later = passes(line, size, 2e-3);  // 4e-3 rad
  ASSERT_TRUE(later);
  EXPECT_NEAR(later->time, 30.0, 1e-9);
  EXPECT_NEAR(later->deviation, std::sqrt(1e-10 + 900.0 * 1e-12) / 1e-4, 1e-9);
  EXPECT_EQ(passes(line, size, 5e-4)->time, 10.0) << "it has been passed";
  line.slope = {-1e-4};
  EXPECT_NEAR(passes(line, size, 2e-3)->time, 50.0, 1e-9) << "on the other side";
  line.slope = {0.0};
  EXPECT_FALSE(passes(line, size, 2e-3));
}

TEST(DriftOverTime, NeedsFourRecordingsAtDifferentTimes) {
  std::vector<TimedChange> changes;
  const auto add = [&](double day, double change) {
    changes.push_back({day * kDay, {change}, {1e-8}, 0.0});
  };
  add(0.0, 0.0);
  add(1.0, 1.0e-3);
  add(2.0, 2.1e-3);
  EXPECT_FALSE(drift_line(changes)) << "three";
  add(3.0, 2.9e-3);
  const auto line = drift_line(changes);
  ASSERT_TRUE(line) << "four";
  EXPECT_EQ(line->recordings, 4);
  // Least squares by hand, of equal weights: (-1.5 * 0 - 0.5 * 1 + 0.5 * 2.1 + 1.5 * 2.9) / 5 = 0.98.
  EXPECT_NEAR(kDay * line->slope[0], 0.98e-3, 1e-12);
  EXPECT_EQ(line->probability, 1.0) << "four cannot tell a drift from a zero that wanders";
  for (TimedChange& of : changes) of.time = 0.0;
  EXPECT_FALSE(drift_line(changes)) << "all at one time";
  changes[1].covariance = {1.0, 0.0};
  EXPECT_THROW((void)drift_line(changes), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
