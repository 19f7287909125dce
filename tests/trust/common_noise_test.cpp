// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/common_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/repeated_scene.hpp"

namespace kinecal {
namespace {

/// The mean over some calibrations.
template <class Figure>
double mean_of(const test::SampleKind& kind, const Figure& figure) {
  constexpr unsigned kRuns = 8;
  double sum = 0.0;
  for (unsigned run = 0; run < kRuns; ++run) {
    sum += figure(test::RepeatedScene(kind, run).assessment()) / kRuns;
  }
  return sum;
}

TEST(CommonNoise, IsThatOfTheJointsAndLeavesThatOfTheFeatures) {
  const test::SampleKind kind{"three points", false, 3, 1, 2e-4, 5e-5, 30, 6};
  const auto repeats = [](const Assessment& of) { return of.common.repeats; };
  EXPECT_NEAR(mean_of(kind, repeats), 0.2, 0.02) << "mrad";
  const auto own = [](const Assessment& of) { return of.noise[0].own; };
  EXPECT_NEAR(mean_of(kind, own), 5e-5, 3e-6);
  const auto all = [](const Assessment& of) { return of.noise[0].sigma; };
  EXPECT_GT(mean_of(kind, all), 1.5e-4);
}

TEST(CommonNoise, IsSmallIfFeaturesErrIndependently) {
  const test::SampleKind kind{"three points", false, 3, 1, 0.0, 1e-4, 30, 6};
  EXPECT_LT(mean_of(kind, [](const Assessment& of) { return of.common.repeats; }), 0.02);
  const auto own = [](const Assessment& of) { return of.noise[0].own / of.noise[0].sigma; };
  EXPECT_NEAR(mean_of(kind, own), 1.0, 0.03);
  EXPECT_LT(mean_of(kind, [](const Assessment& of) { return of.common.scatter; }), 1.3);
}

TEST(CommonNoise, IsNotSeparableWithOnePointInEachPose) {
  EXPECT_FALSE(test::RepeatedScene(test::kSampleKinds[0], 1).assessment().common.separable);
  EXPECT_TRUE(test::RepeatedScene(test::kSampleKinds[1], 1).assessment().common.separable);
}

}  // namespace
}  // namespace kinecal
