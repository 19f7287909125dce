#include "kinecal/trust/uncertainty/pose_elsewhere.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/alike_samples.hpp"

namespace kinecal::test {
namespace {

const FrameOnRobot kTip{"hand"}, kEye{"camera_optical_frame"};

/// A scene's pose at some poses, by its calibration.
PoseUncertainty pose_there(const NoisyScene& scene, const Assessment& step,
                           const std::vector<Sample>& poses) {
  const Eigen::VectorXd values = scene.values();
  return pose_at(scene.solved(), step, NoisyScene::span(values), poses, kTip, kEye);
}

PoseUncertainty pose_by_others(const NoisyScene& scene, const Assessment& step) {
  const Eigen::VectorXd values = scene.values();
  return pose_held_out(scene.solved(), step, NoisyScene::span(values), scene.samples, kTip, kEye);
}

TEST(PoseAt, IsThatOfTheAssessmentAtItsOwnSamples) {
  NoisyScene scene(20);
  const Assessment step = scene.solve_and_assess();
  EXPECT_DOUBLE_EQ(pose_there(scene, step, scene.samples).position, step.compared[0].position);
}

TEST(PoseAt, PosesUnlikeTheSamplesAreKnownWorse) {
  AlikeSamples alike(12);
  const Assessment step = alike.scene.solve_and_assess();
  EXPECT_GT(pose_there(alike.scene, step, alike.others).position, 1.2 * step.compared[0].position);
}

TEST(PoseHeldOut, IsWhatCalibrationsWithoutEachSampleSay) {
  NoisyScene scene(12);
  const Assessment step = scene.solve_and_assess();
  double squares = 0.0;
  for (std::size_t i = 0; i < scene.samples.size(); ++i) {
    NoisyScene others(12);
    others.samples.erase(others.samples.begin() + static_cast<std::ptrdiff_t>(i));
    const Assessment without = others.solve_and_assess();
    squares += std::pow(pose_there(others, without, {scene.samples[i]}).position, 2);
  }
  const double expected = std::sqrt(squares / 12.0);
  constexpr double kOfNoise = 0.15;  // each calibration estimates the noise anew, of 36 rows less
  EXPECT_NEAR(pose_by_others(scene, step).position, expected, kOfNoise * expected);
  EXPECT_GT(pose_by_others(scene, step).position, step.compared[0].position);
}

TEST(PoseHeldOut, ADirectionThatTheOthersDoNotDetermineIsNotDetermined) {
  NoisyScene scene(4);  // ten parameters, three numbers each
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) seen.features.resize(1);
  }
  const Assessment step = scene.solve_and_assess();
  EXPECT_TRUE(step.compared[0].determined);
  EXPECT_FALSE(pose_by_others(scene, step).determined);
}

}  // namespace
}  // namespace kinecal::test
