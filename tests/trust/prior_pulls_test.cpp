#include "kinecal/trust/prior_pulls.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

/// The scene with a prior on where the head stands.
struct WithPrior {
  Assessment found;
  double off = 0.0;        ///< head_pan_x less the truth, metres
  double deviation = 0.0;  ///< of head_pan_x

  [[nodiscard]] const std::vector<PriorPull>& pulls() const { return found.pulls; }
};

/// @param sigma  of the prior, metres; it counts once for each sample
/// @param off    its mean less the truth, metres
WithPrior with_prior(double sigma, double off) {
  test::NoisyScene scene(40);
  scene.solve();
  AnyProblem& problem = *scene.calibration.steps[0].problem;
  Prior prior{.param = "head_pan", .position_scale = 1.0, .rotation_scale = 0.0};
  prior.mean[1] = scene.truth(scene.result.table.index("head_pan_x")) + off;
  prior.mean[2] = scene.truth(scene.result.table.index("head_pan_y"));
  problem.add_prior("stand", prior, {.scale = 1.0 / (sigma * std::sqrt(40.0))});
  scene.result = calibrate(scene.calibration);
  const Eigen::VectorXd values = scene.values();
  const Assessment found = assess(problem, scene.free(), scene.span(values), scene.samples);
  const int x = scene.result.table.index("head_pan_x");
  return {found, values(x) - scene.truth(x), found.deviation(x).value()};
}

TEST(PriorPulls, AreNoneIfThePriorIsRight) {
  EXPECT_TRUE(with_prior(1e-3, 0.0).pulls().empty());
  EXPECT_TRUE(with_prior(1e-3, 1e-3).pulls().empty()) << "off by one of its standard deviations";
}

TEST(PriorPulls, NameAStrongPriorThatTheSamplesContradict) {
  const WithPrior with = with_prior(1e-4, 0.03);
  ASSERT_EQ(with.pulls().size(), 1u);
  EXPECT_EQ(with.pulls()[0].prior, "stand");
  EXPECT_GT(with.pulls()[0].times, 4.0);
}

TEST(PriorPulls, AreInTheUncertaintyOfWhatTheyMove) {
  const WithPrior right = with_prior(1e-4, 0.0), wrong = with_prior(1e-4, 0.03);
  ASSERT_EQ(wrong.pulls().size(), 1u);
  EXPECT_GT(std::abs(wrong.off), 3.0 * right.deviation) << "a believed prior covers less";
  EXPECT_LT(std::abs(wrong.off), 2.0 * wrong.deviation);
}

/// What it moves is far below what the samples say.
TEST(PriorPulls, AreNoneIfThePriorIsWeak) {
  EXPECT_TRUE(with_prior(1.0, 0.03).pulls().empty());
}

}  // namespace
}  // namespace kinecal
