// How often 95 % intervals of real recordings cover: two halves of a recording agree as their +- say; also if each
// pose is read several times.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>

#include "kinecal/trust/calibrate_and_judge.hpp"
#include "support/real_recordings.hpp"

namespace kinecal {
namespace {

/// Values and +- of the parameters that the samples determine.
using Known = std::map<std::string, std::pair<double, double>>;

Known known_of(const test::Recording& of, const std::vector<Sample>& samples) {
  const Robot robot = parse_urdf(of.urdf, "robot.urdf");
  Diagnostics diagnostics;
  Calibration calibration = assemble(of.config, robot, samples, diagnostics);
  ProcedureOptions options;
  options.solving.threads = 1;
  options.folds = 1;
  const JudgedResult judged = calibrate_and_judge(calibration, samples, options);
  Known known;
  for (const int p : calibration.steps.back().free.parameters()) {
    const auto deviation = judged.deviation(p);
    const Parameter& parameter = judged.result.table[p];
    if (deviation && std::isfinite(*deviation)) {
      known[parameter.name] = {parameter.value, *deviation};
    }
  }
  return known;
}

/// Each sample several times, as a robot that stands still reads it.
std::vector<Sample> repeated(const std::vector<Sample>& samples, int times) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Sample> all;
  for (const Sample& sample : samples) {
    for (int i = 0; i < times; ++i) {
      all.push_back(sample);
      for (double& q : all.back().joint_positions) q += 1e-5 * normal(random);
      for (Observation& seen : all.back().observations) {
        for (Feature& feature : seen.features) {
          if (feature.point.isZero()) continue;
          for (int k = 0; k < 3; ++k) feature.point(k) += 2e-5 * normal(random);
        }
      }
    }
  }
  return all;
}

/// How many 95 % intervals of differences contain zero.
struct Covered {
  int hits = 0, intervals = 0;

  void add(const Known& a, const Known& b) {
    constexpr double kHalfWidth = 2.03;  // Student, 35 degrees of freedom
    for (const auto& [name, of_a] : a) {
      const auto of_b = b.find(name);
      if (of_b == b.end()) continue;
      const double width = kHalfWidth * std::hypot(of_a.second, of_b->second.second);
      hits += std::abs(of_a.first - of_b->second.first) <= width ? 1 : 0;
      ++intervals;
    }
  }
  [[nodiscard]] double share() const { return static_cast<double>(hits) / intervals; }
};

class RealCoverage : public testing::TestWithParam<const char*> {};

TEST_P(RealCoverage, IsAsStatedOnceAndWithRepeatedReadings) {
  KINECAL_NEEDS_RECORDING(GetParam());
  const test::Recording of = test::recording(GetParam());
  std::vector<Sample> all = of.samples;
  all.insert(all.end(), of.right.begin(), of.right.end());
  for (const int times : {1, 3, 5}) {
    Covered covered;
    std::mt19937 random(7);
    const int draws = times == 1 ? 20 : 8;
    for (int draw = 0; draw < draws; ++draw) {
      std::vector<Sample> drawn = all;
      std::shuffle(drawn.begin(), drawn.end(), random);
      const auto middle = drawn.begin() + std::ssize(drawn) / 2;
      const std::vector<Sample> first(drawn.begin(), middle), second(middle, drawn.end());
      covered.add(known_of(of, repeated(first, times)), known_of(of, repeated(second, times)));
    }
    std::printf("%s, each pose read %d times: %.1f %% of %d intervals cover\n", of.name.c_str(),
                times, 100.0 * covered.share(), covered.intervals);
    EXPECT_GE(covered.share(), 0.90);
    EXPECT_LE(covered.share(), 0.995);
  }
}

INSTANTIATE_TEST_SUITE_P(OfRealRobots, RealCoverage,
                         testing::Values("ur5", "ur5_offsets", "panda", "kuka"),
                         [](const auto& robot) { return std::string(robot.param); });

}  // namespace
}  // namespace kinecal
