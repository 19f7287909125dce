// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/repeat_noise.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// Reads each pose four times, with noise of its own in each reading.
BlockNoise noise_of_readings(double sigma) {
  test::NoisyScene scene(20);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, sigma);
  std::vector<Sample> all;
  for (const Sample& sample : scene.samples) {
    for (int reading = 0; reading < 4; ++reading) {
      all.push_back(sample);
      for (Feature& feature : all.back().observations[0].features) {
        for (int k = 0; k < 3; ++k) feature.point(k) += noise(random);
      }
    }
  }
  scene.samples = all;
  return scene.solve_and_assess().noise.front();
}

TEST(RepeatNoise, IsThatAmongReadingsOfAPose) {
  const BlockNoise noise = noise_of_readings(5e-5);
  EXPECT_EQ(noise.repeats_freedom, 20 * 3 * 12);
  EXPECT_NEAR(noise.repeats, 5e-5, 5e-6);
  EXPECT_NEAR(noise.sigma, test::kPointNoise, 0.2 * test::kPointNoise);
  EXPECT_TRUE(lacks_fit(noise));
}

TEST(RepeatNoise, DoesNotBlameTheModelWhereSensorsAreNoisy) {
  const BlockNoise noise = noise_of_readings(test::kPointNoise);
  EXPECT_NEAR(noise.repeats, test::kPointNoise, 0.1 * test::kPointNoise);
  EXPECT_FALSE(lacks_fit(noise));
}

TEST(RepeatNoise, IsNotKnownWithoutRepeats) {
  test::NoisyScene scene(30);
  const BlockNoise noise = scene.solve_and_assess().noise.front();
  EXPECT_EQ(noise.repeats, 0.0);
  EXPECT_FALSE(lacks_fit(noise));
}

}  // namespace
}  // namespace kinecal
