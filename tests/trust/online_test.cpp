#include "kinecal/trust/online.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "kinecal/trust/assess.hpp"
#include "support/alike_samples.hpp"
#include "support/pixel_scene.hpp"

namespace kinecal::test {
namespace {

const FrameOnRobot kHand{"hand"}, kCamera{"camera_optical_frame"};

OnlineCalibration follow(const NoisyScene& scene) {
  const Eigen::VectorXd start = scene_table().values();
  return {[&scene] { return scene.problem({}); }, scene.free(), NoisyScene::span(start), kHand,
          kCamera};
}

TEST(Online, EndsWhereTheWholeCalibrationDoes) {
  NoisyScene scene(40);
  OnlineCalibration online = follow(scene);
  OnlineState state;
  for (const Sample& sample : scene.samples) state = online.add(sample);
  EXPECT_EQ(state.samples, 40);
  const Assessment whole = scene.solve_and_assess();
  const FreeSet free = scene.free();
  for (const int p : free.parameters()) {
    const double deviation = whole.deviation(p).value();
    EXPECT_NEAR(online.values()[static_cast<std::size_t>(p)], scene.values()(p), 0.02 * deviation)
        << scene.solved().table()[p].name;
  }
  EXPECT_NEAR(state.noise, 1.0, 0.1);
}

TEST(Online, KnowsThePoseAsWellAsTheWholeCalibration) {
  NoisyScene scene(40);
  OnlineCalibration online = follow(scene);
  OnlineState state;
  for (const Sample& sample : scene.samples) state = online.add(sample);
  const PoseUncertainty whole = scene.solve_and_assess().compared.at(0);
  EXPECT_EQ(whole.frame, kHand.link);
  EXPECT_EQ(whole.in, kCamera.link);
  // Over some of the poses, and with the noise of all blocks.
  EXPECT_TRUE(state.known);
  EXPECT_NEAR(state.position, whole.position, 0.1 * whole.position);
  EXPECT_NEAR(state.rotation, whole.rotation, 0.1 * whole.rotation);
}

TEST(Online, ThePoseIsNotKnownBeforeSamplesDetermineItAndThenGetsBetter) {
  NoisyScene scene(60);
  OnlineCalibration online = follow(scene);
  EXPECT_FALSE(online.add(scene.samples[0]).known);
  double early = 0.0;
  OnlineState state;
  for (std::size_t i = 1; i < scene.samples.size(); ++i) {
    state = online.add(scene.samples[i]);
    if (i == 14) early = state.position;
  }
  ASSERT_GT(early, 0.0);
  EXPECT_LT(state.position, 0.7 * early);  // by root of 4 with alike poses
}

TEST(Online, ThePoseIsNotKnownFromFewerNumbersThanParameters) {
  NoisyScene scene(10);
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) {
      const std::vector<Feature> corners = seen.features;
      for (int copy = 0; copy < 9; ++copy) {
        seen.features.insert(seen.features.end(), corners.begin(), corners.end());
      }
    }
  }
  OnlineCalibration online = follow(scene);
  EXPECT_FALSE(online.add(scene.samples[0]).known) << "120 residuals, but of one body";
  EXPECT_TRUE(online.add(scene.samples[1]).known) << "10 parameters, 12 numbers";
}

TEST(Online, ThePoseIsAsWellKnownAsAtThePosesAhead) {
  const AlikeSamples alike(12);
  OnlineCalibration here = follow(alike.scene), everywhere = follow(alike.scene);
  everywhere.expect(alike.others);
  OnlineState captured, ahead;
  for (const Sample& sample : alike.scene.samples) {
    captured = here.add(sample);
    ahead = everywhere.add(sample);
  }
  EXPECT_GT(ahead.position, 1.2 * captured.position);
  EXPECT_EQ(here.values(), everywhere.values());
}

TEST(Online, LeavesOutASampleThatDoesNotFitAndGoesOn) {
  NoisyScene scene(30);
  Sample ruined = scene.samples[20];
  for (Feature& feature : ruined.observations[0].features) feature.point.x() += 0.02;
  OnlineCalibration online = follow(scene), clean = follow(scene);
  for (std::size_t i = 0; i < 30; ++i) {
    const OnlineState state = online.add(i == 20 ? ruined : scene.samples[i]);
    EXPECT_EQ(state.fits, i != 20) << i << ", " << state.times;
    if (i == 20) {
      EXPECT_GT(state.times, 3.0);
    } else {
      (void)clean.add(scene.samples[i]);
    }
  }
  EXPECT_EQ(online.values(), clean.values());
}

/// How a session takes samples of which one is off by some pixels.
std::vector<bool> fits_of(const PixelScene& scene) {
  const Eigen::VectorXd start = table_with_units().values();
  OnlineCalibration online([&scene] { return scene.problem(); }, scene.free_set(),
                           NoisyScene::span(start), kHand, kCamera);
  std::vector<Sample> samples = scene.samples();
  std::swap(samples[PixelScene::kOff], samples.back());  // when the noise is known
  std::vector<bool> fits;
  for (const Sample& sample : samples) {
    const OnlineState state = online.add(sample);
    fits.push_back(state.fits && state.dropped.empty());
  }
  return fits;
}

TEST(Online, TakesASampleWithinTheStatedSigmaHoweverSmallTheNoiseIs) {
  EXPECT_THAT(fits_of({.noise = 0.01, .sigma = 0.5, .off = 0.09}), testing::Each(true));
  EXPECT_FALSE(fits_of({.noise = 0.01, .sigma = 0.5, .off = 0.8}).back());
}

TEST(Online, ForgetsABadSampleAmongTheFirstOnes) {
  NoisyScene scene(30);
  Sample ruined = scene.samples[2];
  for (Feature& feature : ruined.observations[0].features) feature.point.x() += 0.02;
  OnlineCalibration online = follow(scene), clean = follow(scene);
  std::vector<int> dropped;
  OnlineState state;
  for (std::size_t i = 0; i < 30; ++i) {
    state = online.add(i == 2 ? ruined : scene.samples[i]);
    dropped.insert(dropped.end(), state.dropped.begin(), state.dropped.end());
    EXPECT_TRUE(state.fits) << i;
    if (i != 2) (void)clean.add(scene.samples[i]);
  }
  EXPECT_EQ(dropped, std::vector{3});
  EXPECT_EQ(state.samples, 29);
  for (std::size_t p = 0; p < clean.values().size(); ++p) {
    EXPECT_NEAR(online.values()[p], clean.values()[p], 1e-5);
  }
}

TEST(Online, SaysWhatIsWrongWithASampleAndForgetsIt) {
  NoisyScene scene(10);
  OnlineCalibration online = follow(scene);
  (void)online.add(scene.samples[0]);
  Sample poor = scene.samples[1];
  poor.joint_names.clear();
  poor.joint_positions.clear();
  EXPECT_THROW((void)online.add(poor), SampleError);
  EXPECT_EQ(online.add(scene.samples[1]).samples, 2);
}

TEST(Online, ProposesAMoveThatHelpsMoreThanTheUsualSample) {
  NoisyScene scene(12);
  OnlineCalibration online = follow(scene);
  EXPECT_FALSE(online.next_move().has_value());
  OnlineState state;
  for (const Sample& sample : scene.samples) state = online.add(sample);
  const std::optional<NextMove> move = online.next_move();
  ASSERT_TRUE(move.has_value());
  EXPECT_LT(move->position, state.position);
  const Robot robot = mobile_manipulator();
  const Joint& joint = robot.joint(move->joint);
  const double there = scene.samples.back().position(move->joint).value() + move->change;
  if (joint.limits) {
    EXPECT_GE(there, joint.limits->lower);
    EXPECT_LE(there, joint.limits->upper);
  }
}

}  // namespace
}  // namespace kinecal::test
