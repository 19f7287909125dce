#include "kinecal/trust/pose_elsewhere.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/alike_samples.hpp"

namespace kinecal::test {
namespace {

const FrameOnRobot kHand{"hand"}, kCamera{"camera_optical_frame"};

/// A scene's pose at some poses, by its calibration.
PoseUncertainty at(const NoisyScene& scene, const Assessment& step,
                   const std::vector<Sample>& poses) {
  const Eigen::VectorXd values = scene.values();
  return pose_at(scene.solved(), step, NoisyScene::span(values), poses, kHand, kCamera);
}

PoseUncertainty held_out(const NoisyScene& scene, const Assessment& step) {
  const Eigen::VectorXd values = scene.values();
  return pose_held_out(scene.solved(), step, NoisyScene::span(values), scene.samples, kHand,
                       kCamera);
}

TEST(PoseAt, IsThatOfTheAssessmentAtItsOwnSamples) {
  NoisyScene scene(20);
  const Assessment step = scene.solve_and_assess();
  EXPECT_DOUBLE_EQ(at(scene, step, scene.samples).position, step.pose->position);
}

TEST(PoseAt, PosesUnlikeTheSamplesAreKnownWorse) {
  AlikeSamples alike(12, "elbow");
  const Assessment step = alike.scene.solve_and_assess();
  EXPECT_GT(at(alike.scene, step, alike.others).position, 1.5 * step.pose->position);
}

TEST(PoseHeldOut, IsWhatCalibrationsWithoutEachSampleSay) {
  NoisyScene scene(12);
  const Assessment step = scene.solve_and_assess();
  double squares = 0.0;
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    NoisyScene others(12);
    others.samples.erase(others.samples.begin() + static_cast<std::ptrdiff_t>(i));
    const Assessment without = others.solve_and_assess();
    squares += std::pow(at(others, without, {scene.samples[i]}).position, 2);
  }
  const double expected = std::sqrt(squares / 12.0);
  constexpr double kOfNoise = 0.15;  // each calibration estimates the noise anew, of 36 rows less
  EXPECT_NEAR(held_out(scene, step).position, expected, kOfNoise * expected);
  EXPECT_GT(held_out(scene, step).position, step.pose->position);
}

TEST(PoseHeldOut, ADirectionThatOnlyOneSampleDeterminesIsNotDetermined) {
  NoisyScene scene(2);  // ten parameters, six numbers each
  const Assessment step = scene.solve_and_assess();
  EXPECT_TRUE(step.pose->determined);
  EXPECT_FALSE(held_out(scene, step).determined);
}

}  // namespace
}  // namespace kinecal::test
