#include "kinecal/trust/noise/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

TEST(Noise, IsThatWhichWasAdded) {
  test::NoisyScene scene(50);
  const Assessment found = scene.solve_and_assess();
  ASSERT_EQ(found.noise.size(), 1u);
  const BlockNoise& noise = found.noise[0];
  EXPECT_EQ(noise.features, 200);
  EXPECT_EQ(noise.components, 3);
  EXPECT_NEAR(noise.freedom, 600.0 - 10.0, 1e-6);  // rows less parameters
  // A standard deviation from 590 rows is known to 3 %, one from the median of 200 distances to 6 %.
  EXPECT_NEAR(noise.sigma, test::kPointNoise, 0.1 * test::kPointNoise);
  EXPECT_NEAR(noise.robust, test::kPointNoise, 0.2 * test::kPointNoise);
  EXPECT_DOUBLE_EQ(noise.given, test::kPointNoise);
}

TEST(Noise, IsUnbiasedWhereParametersTakeUpHalfOfTheRows) {
  double squares = 0.0;
  constexpr int kRuns = 60;
  for (unsigned seed = 0; seed < kRuns; ++seed) {
    test::NoisyScene scene(2, seed);  // 24 rows, 10 parameters
    const double sigma = scene.solve_and_assess().noise[0].sigma / test::kPointNoise;
    squares += sigma * sigma / kRuns;
  }
  EXPECT_NEAR(squares, 1.0, 0.2);  // without the leverage it would be 0.58
}

TEST(Noise, OfTheMedianDoesNotSeeAFewRuinedFeatures) {
  std::vector<double> distances(100, 1.0);
  for (std::size_t i = 0; i < distances.size(); ++i) distances[i] = 0.02 * static_cast<double>(i);
  const double before = robust_sigma(distances, 3);
  for (std::size_t i = 0; i < 10; ++i) distances[99 - i] = 1e6;
  EXPECT_EQ(robust_sigma(distances, 3), before);
  EXPECT_EQ(robust_sigma({}, 3), 0.0);
}

/// Poses that differ by 2 mm and 10 mrad in each component, weighted by other scales; a tenth is ruined.
TEST(Noise, OfPosesIsADistanceAndAnAngle) {
  constexpr double kDistance = 2e-3, kAngle = 0.01;
  constexpr Eigen::Index kFeatures = 4000;
  Term term{.name = "hand_eye"};
  term.pose_scales = {500.0, 40.0};
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd residuals(6, kFeatures);
  for (Eigen::Index i = 0; i < kFeatures; ++i) {
    const double ruined = i % 10 == 0 ? 50.0 : 1.0;
    for (int k = 0; k < 6; ++k) {
      residuals(k, i) = ruined * normal(random) * (k < 3 ? 500.0 * kDistance : 40.0 * kAngle);
    }
  }
  BlockNoise noise, of_points;
  noise.freedom = of_points.freedom = 6.0 * kFeatures;
  detail::set_pose_errors(term, residuals, noise);
  constexpr double kOfTenth = 1.08;  // a tenth beyond moves the median so far
  EXPECT_NEAR(noise.distance, kOfTenth * std::sqrt(3.0) * kDistance, 0.03 * noise.distance);
  EXPECT_NEAR(noise.angle, kOfTenth * std::sqrt(3.0) * kAngle, 0.03 * noise.angle);
  noise.unit_sigma = 2.0;  // a sigma of 2 halves the weighted residuals
  const double once = noise.distance;
  detail::set_pose_errors(term, residuals, noise);
  EXPECT_NEAR(noise.distance, 2.0 * once, 1e-12);
  detail::set_pose_errors(Term{.name = "points"}, residuals, of_points);
  EXPECT_EQ(of_points.distance, 0.0);
}

TEST(Noise, OfTheMedianIsThatOfChiSquare) {
  // Medians of the distance from tables of chi-square: sqrt 0.4549, 1.3863, 2.3660.
  EXPECT_NEAR(robust_sigma({0.67449}, 1), 1.0, 0.02);
  EXPECT_NEAR(robust_sigma({1.17741}, 2), 1.0, 0.01);
  EXPECT_NEAR(robust_sigma({1.53817}, 3), 1.0, 0.01);
}

}  // namespace
}  // namespace kinecal
