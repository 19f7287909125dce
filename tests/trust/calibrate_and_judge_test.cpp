#include "kinecal/trust/calibrate_and_judge.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinecal/trust/judge_shards.hpp"
#include "support/noisy_scene.hpp"
#include "support/oracle.hpp"
#include "support/static_robot.hpp"
#include "support/thrown.hpp"
#include "support/unknown_poses.hpp"

namespace kinecal {
namespace {

using test::NoisyScene;
using test::StaticRobot;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A calibration of the scene.  A sample of these is ruined.
Calibration calibration_of(const NoisyScene& scene) {
  return make_calibration(scene.problem({}), scene.free(), scene.samples);
}
void ruin(Sample& sample) {
  for (Feature& feature : sample.observations[0].features) feature.point.x() += 0.05;
}

TEST(CalibrateAndJudge, LeavesOutRuinedSamplesAndNamesThem) {
  NoisyScene scene(60);
  for (const int i : {3, 17, 44}) ruin(scene.samples[static_cast<std::size_t>(i)]);
  Calibration calibration = calibration_of(scene);
  const JudgedResult judged = calibrate_and_judge(calibration, scene.samples);
  std::vector<int> numbers;
  for (const LeftOutSample& left : judged.left_out) {
    numbers.push_back(left.number);
    EXPECT_EQ(left.source, scene.samples[static_cast<std::size_t>(left.number - 1)].source);
    EXPECT_THAT(left.why, HasSubstr("error block 'points': all features are about"));
  }
  EXPECT_THAT(numbers, ElementsAre(4, 18, 45));
  EXPECT_EQ(judged.numbers.size(), 57u);
  EXPECT_EQ(calibration.steps[0].problem->num_samples(), 57);
  EXPECT_EQ(used_samples(judged, scene.samples).size(), 57u);
  constexpr double kSame = 1e-9;  // of parameters, radians and metres
  const Eigen::VectorXd alone = scene.values_without({3, 17, 44});
  EXPECT_LE((judged.result.table.values() - alone).norm(), kSame);
}

TEST(CalibrateAndJudge, KeepsWhatItIsToldToKeepAndLeavesOutWhatItIsToldTo) {
  NoisyScene scene(30);
  ruin(scene.samples[5]);
  Calibration calibration = calibration_of(scene);
  ProcedureOptions options;
  options.keep_outliers = true;
  options.exclude = {{0, "--exclude"}, {29, "--exclude"}};
  const JudgedResult judged = calibrate_and_judge(calibration, scene.samples, options);
  ASSERT_EQ(judged.left_out.size(), 2u);
  EXPECT_EQ(judged.left_out[1].number, 30);
  EXPECT_EQ(judged.left_out[1].why, "--exclude");
  EXPECT_EQ(judged.numbers.size(), 28u);
  EXPECT_TRUE(judged.assessments[0].captures[4].bad);
  options.exclude = {{30, "no such sample"}};
  Calibration other = calibration_of(scene);
  EXPECT_THROW((void)calibrate_and_judge(other, scene.samples, options), std::invalid_argument);
}

TEST(CalibrateAndJudge, FailsIfNoSampleIsLeft) {
  NoisyScene scene(2);
  Calibration calibration = calibration_of(scene);
  ProcedureOptions options;
  options.exclude = {{0, "bad"}, {1, "bad"}};
  EXPECT_THAT(test::thrown<std::invalid_argument>(
                  [&] { (void)calibrate_and_judge(calibration, scene.samples, options); }),
              HasSubstr("step 'calibration': the samples that are left"));
}

TEST(CalibrateAndJudge, EstimatesTheNoiseOfABlockWithALoss) {
  NoisyScene scene(60);
  scene.options = {.loss = {LossType::huber, 3.0}};
  Calibration calibration = calibration_of(scene);
  const JudgedResult judged = calibrate_and_judge(calibration, scene.samples);
  const double sigma = calibration.steps[0].problem->term(0).sigma;
  EXPECT_NEAR(sigma, test::kPointNoise, 0.1 * test::kPointNoise);
  EXPECT_EQ(judged.assessments[0].noise[0].given, 0.0);
  NoisyScene alone(60);
  alone.options = {};
  Calibration without_loss = calibration_of(alone);
  (void)calibrate_and_judge(without_loss, alone.samples);
  EXPECT_EQ(without_loss.steps[0].problem->term(0).sigma, 1.0) << "it would not matter";
}

TEST(CalibrateAndJudge, OfShardsIsThatOfAllSamples) {
  NoisyScene scene(90);
  scene.options = {.loss = {LossType::huber, 3.0}};
  Calibration whole = calibration_of(scene);
  ProcedureOptions options;
  options.keep_outliers = true;
  const JudgedResult expected = calibrate_and_judge(whole, scene.samples, options);
  const auto shard = [&](int s) {
    const auto first = scene.samples.begin() + 30 * s;
    return std::vector<Sample>(first, first + 30);
  };
  const std::vector<Sample> drawn = shard(0);
  Calibration of_draw = make_calibration(scene.problem({}), scene.free(), drawn);
  const ShardedCalibration sharded{.calibration = of_draw,
                                   .samples = drawn,
                                   .names = {"one", "two", "three"},
                                   .num_samples = 90,
                                   .num_residuals = {whole.steps[0].problem->num_residuals()},
                                   .free = {whole.steps[0].free},
                                   .read = shard};
  const JudgedResult judged = calibrate_and_judge(sharded, options);
  constexpr double kSame = 2e-3;  // sigma is estimated to 1 %
  const Eigen::VectorXd values = expected.result.table.values();
  EXPECT_LE((judged.result.table.values() - values).norm(), kSame * values.norm());
  EXPECT_EQ(judged.judgement.verdict, expected.judgement.verdict);
  EXPECT_EQ(judged.result.steps.back().samples, 90);
  EXPECT_TRUE(judged.numbers.empty()) << "of a thousand million samples they would fill the memory";
  EXPECT_NEAR(of_draw.steps[0].problem->term(0).sigma, whole.steps[0].problem->term(0).sigma,
              0.02 * whole.steps[0].problem->term(0).sigma);
}

}  // namespace
}  // namespace kinecal
