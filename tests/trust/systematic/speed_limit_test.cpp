// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/systematic/speed_limit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr double kNoise = 3e-4;  // metres, of each coordinate
constexpr double kLag = 0.015;   // seconds

/// How samples of a motion are off.
struct Motion {
  double jitter = 0.0;                  ///< of the stamps, seconds
  double repeats = 0.0;                 ///< of joints, radians
  bool free = true;                     ///< the lag
  bool has_arm = true;                  ///< the arm has a lag, as the camera has
  double wrong = 0.0;                   ///< share of samples whose stamp is 50 ms off
  double slowest = 0.0, fastest = 0.5;  ///< rad/s
  unsigned seed = 1;
};

/// Calibrates a robot that moves, and asks how fast it may.
std::vector<SpeedLimit> limits_of(const Motion& motion, int count = 300) {
  test::NoisyScene scene(count, motion.seed);
  scene.samples.clear();
  ParameterTable table = test::table_with_units();
  for (const char* lag : {"camera_lag", "arm_lag"}) {
    if (!motion.has_arm && lag == std::string("arm_lag")) continue;
    table.add({.name = lag, .unit = "s", .value = motion.free ? 0.0 : kLag});
  }
  const auto problem =
      make_problem(test::mobile_manipulator(), "base_link", table, test::kSceneFrames);
  problem->add_built_in(ChainPoint{}, {"arm", "hand"});
  problem->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem->add_built_in("points", PointToPoint{}, {"camera", "arm"}, {.sigma = 1e-3});
  std::mt19937 random(motion.seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<Sample> samples = test::exact_samples(
      test::scene_problem(), test::NoisyScene::span(scene.truth), count, "hand", motion.seed);
  for (std::size_t s = 0; s < samples.size(); ++s) {
    Sample& sample = samples[s];
    const double share = static_cast<double>(s) / static_cast<double>(samples.size());
    const double speed = motion.slowest + (motion.fastest - motion.slowest) * share;
    const double stray = uniform(random) < 2.0 * motion.wrong - 1.0 ? 0.05 : 0.0;
    const double late = kLag + motion.jitter * normal(random) + stray;
    for (double& position : sample.joint_positions) {
      const double velocity = speed * uniform(random);
      sample.joint_velocities.push_back(velocity);
      position += motion.repeats * normal(random) - late * velocity;
    }
    for (Feature& feature : sample.observations[0].features) {
      for (int k = 0; k < 3; ++k) feature.point(k) += kNoise * normal(random);
    }
    problem->add_sample(sample);
  }
  std::vector<std::string> names = test::kNoisyFree;
  if (motion.free) names.push_back("camera_lag");
  if (motion.free && motion.has_arm) names.push_back("arm_lag");
  const FreeSet free = test::free_of(table, names);
  Eigen::VectorXd values = table.values();
  EXPECT_TRUE(solve(*problem, free, values).converged);
  if (motion.has_arm) {
    EXPECT_NEAR(values(table.index("camera_lag")), kLag, 2e-3);
  }
  return speed_limits(*problem, free, test::NoisyScene::span(values), samples);
}

TEST(SpeedLimit, FindsTheJitterOfStamps) {
  constexpr double kJitter = 2e-3;
  for (const bool free : {true, false}) {
    for (const unsigned seed : {1U, 2U, 3U}) {
      const auto limits = limits_of({.jitter = kJitter, .free = free, .seed = seed});
      ASSERT_EQ(limits.size(), 1U);
      EXPECT_EQ(limits[0].sensors, "camera and arm");
      EXPECT_NEAR(limits[0].jitter, kJitter, 0.2 * kJitter) << seed;
      EXPECT_GE(limits[0].jitter_most, limits[0].jitter);
      EXPECT_EQ(limits[0].lag_deviation > 0.0, free);
      EXPECT_THAT(limits[0].text(), StartsWith("camera and arm: stamps jitter by "));
      EXPECT_THAT(limits[0].text(), HasSubstr(" rad/s motion adds less than a third of the noise"));
    }
  }
}

TEST(SpeedLimit, IsWhereMotionAddsAThirdOfTheNoise) {
  // Joints and features 0.5 to 1 m apart: 2 ms at w rad/s are about 1 mm w, the noise is 0.3 mm.
  const double speed = limits_of({.jitter = 2e-3}).at(0).speed;
  EXPECT_GT(speed, 0.03);
  EXPECT_LT(speed, 0.3);
  EXPECT_NEAR(limits_of({.jitter = 4e-3}).at(0).speed, 0.5 * speed, 0.1 * speed);
}

TEST(SpeedLimit, InventsNoJitter) {
  int invented = 0;
  constexpr unsigned kSeeds = 20;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const SpeedLimit limit = limits_of({.seed = seed}, 100).at(0);
    invented += limit.jitter > 0.0 ? 1 : 0;
    EXPECT_LT(limit.jitter_most, 1e-3) << seed;
    EXPECT_EQ(limit.text().find("jitter by less than ") != std::string::npos, limit.jitter == 0.0)
        << seed;
  }
  EXPECT_EQ(invented, 0) << "one in a thousand is chance";
}

TEST(SpeedLimit, DoesNotTakeJointsThatDoNotRepeatForJitter) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const SpeedLimit still = limits_of({.repeats = 5e-4, .seed = seed}).at(0);
    EXPECT_EQ(still.jitter, 0.0) << seed;
    const SpeedLimit both = limits_of({.jitter = 3e-3, .repeats = 5e-4, .seed = seed}).at(0);
    EXPECT_NEAR(both.jitter, 3e-3, 0.3 * 3e-3) << seed;
  }
}

TEST(SpeedLimit, IsNotMisledByAFewWrongStamps) {
  const SpeedLimit limit = limits_of({.jitter = 2e-3, .wrong = 0.03}).at(0);
  EXPECT_NEAR(limit.jitter, 2e-3, 0.3 * 2e-3);
}

TEST(SpeedLimit, OfSamplesOfOneSpeedSaysThatNoJitterIsSeen) {
  const SpeedLimit limit = limits_of({.repeats = 1e-3, .slowest = 0.3, .fastest = 0.3}).at(0);
  EXPECT_EQ(limit.jitter, 0.0);
}

TEST(SpeedLimit, IsNotKnownIfSomethingElseMovesWithoutALag) {
  EXPECT_TRUE(limits_of({.has_arm = false}, 60).empty());
}

TEST(SpeedLimit, OfARobotThatStandsIsNotKnown) {
  EXPECT_TRUE(limits_of({.free = false, .fastest = 0.0}).empty());
}

}  // namespace
}  // namespace kinecal
