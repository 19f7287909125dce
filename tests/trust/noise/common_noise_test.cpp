// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/noise/common_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/trust/noise/joint_effects.ipp"
#include "kinecal/trust/noise/pose_rows.ipp"
#include "support/repeated_scene.hpp"
#include "support/tracked_arm.hpp"

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
  EXPECT_NEAR(mean_of(kind, repeats), 0.2, 0.03) << "mrad; found to 8 % each";
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
  EXPECT_LT(mean_of(kind, [](const Assessment& of) { return of.common.effect; }), 1.15);
}

TEST(CommonNoise, IsNotSeparableWithOnePointInEachPose) {
  EXPECT_FALSE(test::RepeatedScene(test::kSampleKinds[0], 1).assessment().common.separable);
  EXPECT_TRUE(test::RepeatedScene(test::kSampleKinds[1], 1).assessment().common.separable);
}

/// Squares of the residuals of a calibration, over those that its noise predicts.
double observed_over_predicted(const test::TrackedArm& arm) {
  const BlockNoise& noise = arm.assessment().noise[0];
  const Eigen::VectorXd at = arm.values();
  const ParameterValues values(at.data(), static_cast<std::size_t>(at.size()));
  const auto evaluator = arm.fitted().evaluator(arm.free(), 1);
  const LinearFit fit =
      linear_fit(*evaluator, values, determined_coordinates(arm.fitted(), arm.free(), values));
  const Eigen::MatrixXd effects =
      detail::joint_effects(arm.fitted(), values, arm.calibrated(), arm.free(), fit) / noise.own;
  const Eigen::MatrixXd shifted = detail::feature_shifts(fit, std::vector<int>{noise.components});
  double predicted = 0.0;
  for (const RowBlock& block : fit.blocks) {  // of a pose
    const Eigen::MatrixXd shared = detail::shared_columns(
        effects.middleRows(block.first, block.size), shifted.middleRows(block.first, block.size),
        arm.assessment().common);
    predicted += static_cast<double>(block.size) + shared.squaredNorm();
  }
  const double times = noise.sigma / noise.own;
  return times * times * static_cast<double>(fit.residual.size()) / predicted;
}

TEST(CommonNoise, ReproducesTheSumsOfSquaresOfThePosesThoughTheModelIsNotExact) {
  for (const test::ArmKind& kind : test::kArmKinds) {
    for (unsigned run = 0; run < 3 && kind.points > 1; ++run) {
      // Predicted are squares of errors, and leverage turns residuals into these but for 10 %.
      EXPECT_NEAR(observed_over_predicted(test::TrackedArm(kind, run)), 1.0, 0.15) << kind.name;
    }
  }
}

TEST(CommonNoise, LeavesLittleForTheEffectOnGradients) {
  for (const test::ArmKind& kind : test::kArmKinds) {
    double sum = 0.0;
    constexpr unsigned kRuns = 4;
    for (unsigned run = 0; run < kRuns; ++run) {
      sum += test::TrackedArm(kind, run).assessment().common.effect / kRuns;
    }
    EXPECT_LT(sum, 1.7) << kind.name;
  }
}

}  // namespace
}  // namespace kinecal
