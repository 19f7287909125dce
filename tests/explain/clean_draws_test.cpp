// Samples in which nothing is wrong but noise: nothing is named.
#include <gtest/gtest.h>

#include <cstdio>

#include "kinecal/procedure/calibrate_robot.hpp"
#include "support/repetitions.hpp"
#include "support/spoiled_robot.hpp"

namespace kinecal {
namespace {

/// @param count  of samples
CalibrationSetup drawn(const test::SpoiledRobot& arm, std::size_t count) {
  const std::vector<Sample>& all = arm.samples();
  return {.robot = arm.robot(),
          .config = arm.config(),
          .samples = {all.begin(),
                      all.begin() + static_cast<std::ptrdiff_t>(std::min(count, all.size()))}};
}

TEST(CleanDraws, HaveNoCause) {
  const int seeds = test::repetitions_of_study(125, 3);
  int draws = 0, named = 0, advised = 0;
  for (const std::size_t kind : {0u, 2u, 4u, 5u}) {
    for (int seed = 1; seed <= seeds; ++seed) {
      test::SpoiledRobot arm(static_cast<unsigned>(seed), test::robot_kinds()[kind]);
      arm.spoil(0);
      for (const std::size_t count : {25u, 100u}) {
        const CalibratedRobot found = calibrate_robot(drawn(arm, count));
        ++draws;
        named += found.judgement.causes > 0 ? 1 : 0;
        advised += found.helps.empty() ? 0 : 1;
        if (found.judgement.causes > 0 || !found.helps.empty()) {
          std::printf("%s, seed %d, %zu samples: %s %s\n", test::robot_kinds()[kind].name.c_str(),
                      seed, count,
                      found.judgement.causes > 0 ? found.judgement.reasons.front().c_str() : "",
                      found.helps.empty() ? "" : found.helps.front().c_str());
        }
      }
    }
  }
  std::printf("of %d clean draws %d with a cause, %d with advice\n", draws, named, advised);
  const int most = test::binomial_band(draws, 0.01, 1e-3).most;
  EXPECT_LE(named, most);
}

}  // namespace
}  // namespace kinecal
