// Bases that are simulated: errors of 2 % are recovered within honest limits, slips are left out; and what base_calibration
// of robot_calibration computes from the same data.
#include "kinecal/study/simulated_base.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/base_problem.hpp"
#include "support/interval_coverage.hpp"
#include "support/wrong_base.hpp"

namespace kinecal {
namespace {

using test::wrong_base;
using testing::HasSubstr;

/// With a millionth of the noise.
SimulatedBase exact(SimulatedBase base) {
  for (double* noise : {&base.tracked_position, &base.tracked_angle, &base.wall_distance,
                        &base.rolling, &base.gyro}) {
    *noise *= 1e-6;
  }
  return base;
}

double value(const JudgedResult& judged, const std::string& name) {
  return judged.result.table["base_" + name].value;
}

template <class B>
JudgedResult calibrated(const SimulatedBase& base, const SimulatedBase& seen_as,
                        const std::vector<std::string>& names, std::uint64_t seed = 1) {
  return test::judged_base(test::block_of<B>(seen_as), names,
                           simulate_base(base, all_runs(), seed).samples);
}

TEST(SimulatedBase, ErrorsAreFound) {
  constexpr double kExact = 1e-7;  // a millionth of 2 mm and 2 mrad, over runs of a metre or a turn
  const SimulatedBase noisy = wrong_base(), base = exact(noisy);
  const std::vector<std::string> scales{"track_width_scale", "rollout_scale"};
  for (const JudgedResult& judged : {calibrated<DifferentialToPose>(base, noisy, scales),
                                     calibrated<DifferentialToWall>(base, noisy, scales),
                                     calibrated<OdometryToPose>(base, noisy, scales),
                                     calibrated<OdometryToWall>(base, noisy, scales)}) {
    ASSERT_TRUE(judged.result.converged) << judged.result.termination;
    EXPECT_NEAR(value(judged, "track_width_scale"), 1.02, kExact);
    EXPECT_NEAR(value(judged, "rollout_scale"), 0.98, kExact);
  }
  for (const JudgedResult& judged : {calibrated<GyroToPose>(base, noisy, {"scale", "bias"}),
                                     calibrated<GyroToWall>(base, noisy, {"scale", "bias"})}) {
    EXPECT_NEAR(value(judged, "scale"), 0.98, kExact);
    EXPECT_NEAR(value(judged, "bias"), 0.002, kExact);
  }
}

TEST(SimulatedBase, WheelsAndTheMountOfTheLaserAreFoundTogether) {
  constexpr double kExact = 1e-7;  // as above
  SimulatedBase noisy = wrong_base(), base = exact(noisy);
  base.left_rollout_scale = 0.985;
  base.mount = {0.26, -0.02, 0.05};
  const JudgedResult judged = calibrated<DifferentialToPose>(
      base, noisy,
      {"track_width_scale", "left_rollout_scale", "right_rollout_scale", "x", "y", "yaw"});
  const std::map<std::string, double> truth{{"track_width_scale", 1.02},
                                            {"left_rollout_scale", 0.985},
                                            {"right_rollout_scale", 0.98},
                                            {"x", 0.26},
                                            {"y", -0.02},
                                            {"yaw", 0.05}};
  for (const auto& [name, is] : truth) EXPECT_NEAR(value(judged, name), is, kExact) << name;
}

/// Both wheels and each of them: a combination that nothing determines keeps its start, and is said.
TEST(SimulatedBase, WhatIsNotDeterminedIsSaid) {
  const JudgedResult judged = calibrated<DifferentialToPose>(
      wrong_base(), wrong_base(),
      {"track_width_scale", "rollout_scale", "left_rollout_scale", "right_rollout_scale"});
  EXPECT_EQ(judged.assessments.back().observability.rank, 3);
}

/// @param of_runs  how far runs differ
/// @param exceed   few runs of tracked poses: intervals may be wider
/// @param numbered false: the recording does not say where a run begins
template <class B>
void expect_coverage(const char* name, const std::vector<std::string>& names,
                     const std::map<std::string, double>& truth, double of_runs,
                     bool exceed = false, bool numbered = true) {
  const int repetitions = test::repetitions(100, 12);
  test::IntervalCoverage coverage(name);
  for (int n = 0; n < repetitions; ++n) {
    SimulatedBase base = wrong_base();
    base.of_runs = of_runs;
    std::vector<Sample> samples =
        simulate_base(base, all_runs(), static_cast<std::uint64_t>(n + 1)).samples;
    for (Sample& sample : samples) {
      if (!numbered) sample.conditions.erase(kRun);
    }
    const JudgedResult judged = test::judged_base(test::block_of<B>(base), names, samples);
    ASSERT_TRUE(judged.result.converged);
    EXPECT_NE(judged.judgement.verdict, Grade::do_not_use) << n;
    coverage.add(judged.result, judged.assessments.back(),
                 [&](const std::string& of) { return truth.at(of.substr(5)); });
  }
  coverage.check(exceed);
}

TEST(BaseCoverage, IntervalsOfWheelsCoverTheTruth) {
  expect_coverage<DifferentialToPose>(
      "wheels, tracked pose", {"track_width_scale", "left_rollout_scale", "right_rollout_scale"},
      {{"track_width_scale", 1.02}, {"left_rollout_scale", 0.98}, {"right_rollout_scale", 0.98}},
      0.0, true);
}
TEST(BaseCoverage, IntervalsByTheWallCoverTheTruth) {
  expect_coverage<OdometryToWall>("odometry, wall", {"track_width_scale", "rollout_scale"},
                                  {{"track_width_scale", 1.02}, {"rollout_scale", 0.98}}, 0.0,
                                  true);
}
TEST(BaseCoverage, IntervalsOfTheGyroscopeCoverTheTruth) {
  expect_coverage<GyroToWall>("gyroscope, wall", {"scale", "bias"},
                              {{"scale", 0.98}, {"bias", 0.002}}, 0.0);
}
/// The floor of each run is another one: samples of a run err alike.
TEST(BaseCoverage, IntervalsCoverTheTruthWhereRunsDiffer) {
  expect_coverage<DifferentialToPose>(
      "wheels, runs that differ by 0.5 %", {"track_width_scale", "rollout_scale"},
      {{"track_width_scale", 1.02}, {"rollout_scale", 0.98}}, 0.005);
}
TEST(BaseCoverage, IntervalsCoverTheTruthWhereRunsDifferAndAreNotNumbered) {
  expect_coverage<DifferentialToPose>("wheels, runs that differ by 0.5 % and are not numbered",
                                      {"track_width_scale", "rollout_scale"},
                                      {{"track_width_scale", 1.02}, {"rollout_scale", 0.98}}, 0.005,
                                      false, false);
}

/// The sensor is elsewhere in each run: so its pose on the base is not better known than runs agree.
TEST(BaseCoverage, IntervalsOfTheMountCoverTheTruthWhereItDiffersBetweenRuns) {
  const int repetitions = test::repetitions(100, 12);
  test::IntervalCoverage coverage("mount that differs by 4 mm and 4 mrad between runs");
  for (int n = 0; n < repetitions; ++n) {
    SimulatedBase base = wrong_base();
    base.mount_of_runs = 0.004;  // twice the noise of a sample, which has hundreds of neighbours
    const JudgedResult judged = calibrated<DifferentialToPose>(
        base, base, {"track_width_scale", "rollout_scale", "x", "y", "yaw"},
        static_cast<std::uint64_t>(n + 1));
    ASSERT_TRUE(judged.result.converged);
    const std::map<std::string, double> truth{{"base_track_width_scale", 1.02},
                                              {"base_rollout_scale", 0.98},
                                              {"base_x", 0.23},
                                              {"base_y", 0.0},
                                              {"base_yaw", 0.0}};
    coverage.add(judged.result, judged.assessments.back(),
                 [&](const std::string& of) { return truth.at(of); });
  }
  coverage.check();
}

TEST(SimulatedBase, SlipsAreLeftOut) {
  SimulatedBase base = wrong_base();
  base.slip_chance = 0.03;
  const BaseRecording recording = simulate_base(base, all_runs(), 3);
  ASSERT_GT(recording.slipped.size(), 3u);
  const JudgedResult judged =
      test::judged_base(test::block_of<DifferentialToPose>(base),
                        {"track_width_scale", "rollout_scale"}, recording.samples);
  std::set<int> left_out;
  for (const LeftOutSample& sample : judged.left_out) {
    left_out.insert(sample.number - 1);
    EXPECT_THAT(sample.why, HasSubstr("_wheel' advanced by 0.8"));  // 0.05 m of a radius of 0.06 m
    EXPECT_THAT(sample.why, HasSubstr("too much: it slipped"));
  }
  EXPECT_EQ(left_out, std::set<int>(recording.slipped.begin(), recording.slipped.end()));
  for (const auto& [name, truth] :
       {std::pair("track_width_scale", 1.02), {"rollout_scale", 0.98}}) {
    const auto deviation =
        judged.assessments.back().deviation(judged.result.table.index("base_" + std::string(name)));
    ASSERT_TRUE(deviation) << name;
    EXPECT_NEAR(value(judged, name), truth, 4.0 * *deviation) << name;
  }
}

/// What base_calibration of robot_calibration computes: means of what the wall shows over what was counted, of turns in place
/// and of straight runs.
struct UpstreamRatios {
  double turn = 0.0, way = 0.0;
};
/// @param counted  "odom_yaw" or "gyro_yaw"
UpstreamRatios upstream_ratios(const std::vector<Sample>& samples, const std::string& counted) {
  UpstreamRatios sum;
  int turns = 0, ways = 0;
  for (std::size_t first = 0, last = 0; first < samples.size(); first = last + 1) {
    const auto at = [&](std::size_t i, const std::string& name) {
      return samples[i].conditions.at(name);
    };
    for (last = first; last + 1 < samples.size() && at(last + 1, kRun) == at(first, kRun);) ++last;
    const auto by = [&](const std::string& name) { return at(last, name) - at(first, name); };
    if (const double said = by(counted); std::abs(said) > 4.0) {  // a full turn
      const double full = std::copysign(2.0 * std::numbers::pi, said);
      sum.turn += 1.0 + (full - by("wall_angle") - said) / said;
      ++turns;
    } else {
      const double way = std::hypot(by("odom_x"), by("odom_y"));
      sum.way += 1.0 + (std::abs(by("wall_distance")) - way) / way;
      ++ways;
    }
  }
  return {sum.turn / turns, sum.way / ways};
}

TEST(SimulatedBase, UpstreamsFormulaOfRos1HasTheReciprocalOfTheTrackWidth) {
  constexpr double kExact = 1e-6;  // its means have the noise of two samples of each run
  const std::vector<Sample> samples =
      simulate_base(exact(wrong_base()), turns_and_straight_runs(), 1).samples;
  // The true turn over the reported one: the odometry divides by the track width, and rolls less.
  EXPECT_NEAR(upstream_ratios(samples, "odom_yaw").turn, 0.98 / 1.02, kExact);
  const JudgedResult judged = test::judged_base(test::block_of<OdometryToWall>(wrong_base()),
                                                {"track_width_scale", "rollout_scale"}, samples);
  EXPECT_NEAR(value(judged, "track_width_scale") / value(judged, "rollout_scale"), 1.02 / 0.98,
              kExact);
}

/// Upstream since 0.10: rollout_scale is the mean of the ways, track_width_scale is that over the mean of the turns.  Ours
/// looks at all samples.
TEST(SimulatedBase, IsNotFartherFromTheTruthThanUpstreamsFormula) {
  const int repetitions = test::repetitions_of_study(100, 12);
  double upstream = 0.0, ours = 0.0;  // sums of squares
  for (int n = 0; n < repetitions; ++n) {
    const std::vector<Sample> samples =
        simulate_base(wrong_base(), turns_and_straight_runs(), static_cast<std::uint64_t>(n + 1))
            .samples;
    const UpstreamRatios ratios = upstream_ratios(samples, "odom_yaw");
    const JudgedResult judged = test::judged_base(test::block_of<OdometryToWall>(wrong_base()),
                                                  {"track_width_scale", "rollout_scale"}, samples);
    const double track = ratios.way / ratios.turn;
    EXPECT_NEAR(track, 1.02, 0.02) << "nearer to the truth than the nominal 1";
    EXPECT_NEAR(ratios.way, 0.98, 0.02) << "nearer to the truth than the nominal 1";
    upstream += (track - 1.02) * (track - 1.02) + (ratios.way - 0.98) * (ratios.way - 0.98);
    const double of_track = value(judged, "track_width_scale") - 1.02,
                 of_rollout = value(judged, "rollout_scale") - 0.98;
    ours += of_track * of_track + of_rollout * of_rollout;
  }
  RecordProperty("upstream_rms", std::to_string(std::sqrt(0.5 * upstream / repetitions)));
  RecordProperty("ours_rms", std::to_string(std::sqrt(0.5 * ours / repetitions)));
  // Both err by the noise of the same drives; a fifth is what a sum of a dozen drives may differ by.
  EXPECT_LT(ours, 1.2 * upstream);
}

}  // namespace
}  // namespace kinecal
