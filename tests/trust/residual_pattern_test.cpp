// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/residual_pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "kinecal/trust/joint_effects.ipp"
#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

std::optional<ResidualPattern> pattern_in(test::NoisyScene& scene) {
  scene.solve();
  const FreeSet free = scene.free();
  const auto evaluator = scene.solved().evaluator(free);
  const LinearFit fit = scene.linear(*evaluator);
  const Eigen::VectorXd values = scene.values();
  return residual_pattern(scene.solved(), free, fit, values, scene.samples,
                          each_its_own(scene.samples.size()),
                          detail::joint_effects(scene.solved(), values, scene.samples, free, fit));
}

double position(const Sample& sample, const std::string& joint) {
  return sample.position(joint).value();
}

TEST(ResidualPattern, IsNoneInSamplesAsTheyShouldBe) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    test::NoisyScene scene(20, seed);
    EXPECT_FALSE(pattern_in(scene)) << seed;
  }
}

TEST(ResidualPattern, FindsTheGearOfAJoint) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow", [](std::size_t, double q) { return 0.02 * q; });
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::gear);
  EXPECT_NEAR(found->factor, 1.02, 0.002);
  EXPECT_LT(found->noise_left, 0.5);
}

TEST(ResidualPattern, FindsAZeroThatIsHeld) {
  test::NoisyScene scene(40);
  std::erase(scene.names, "elbow");
  test::misread(scene, "elbow", [](std::size_t, double) { return 0.02; });
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::zero);
}

TEST(ResidualPattern, FindsAnEccentricEncoder) {
  test::NoisyScene scene(40);
  test::misread(scene, "shoulder_lift",
                [](std::size_t, double q) { return 0.02 * std::sin(q + 1.0); });
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "shoulder_lift");
  EXPECT_EQ(found->course, ErrorCourse::turn);
  EXPECT_NEAR(found->size, 0.02, 0.006);
}

TEST(ResidualPattern, FindsBacklashByTheDirectionOfMotion) {
  test::NoisyScene scene(40);
  const std::vector<Sample> before = scene.samples;
  test::misread(scene, "elbow", [&](std::size_t s, double q) {
    const double from = s == 0 ? q : position(before[s - 1], "elbow");
    return q > from ? 0.01 : -0.01;
  });
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->course, ErrorCourse::backlash);
  EXPECT_NEAR(found->size, 0.02, 0.002);
}

TEST(ResidualPattern, FindsSamplesThatWereTakenBeforeTheRobotStood) {
  test::NoisyScene scene(40);
  const std::vector<Sample> before = scene.samples;
  for (std::size_t s = 1; s < before.size(); ++s) {
    for (std::size_t j = 0; j < before[s].joint_positions.size(); ++j) {
      scene.samples[s].joint_positions[j] +=
          0.02 * (before[s].joint_positions[j] - before[s - 1].joint_positions[j]);
    }
  }
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->course, ErrorCourse::lag);
  EXPECT_NEAR(found->size, 0.02, 0.003);
}

TEST(ResidualPattern, FindsAnAxisOfASensorWithAnotherScale) {
  test::NoisyScene scene(40);
  std::erase(scene.names, "camera_fx");
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      for (Feature& feature : seen.features) feature.point.x() *= 1.03;
    }
  }
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "camera");
  EXPECT_EQ(found->course, ErrorCourse::axis);
  EXPECT_EQ(found->axis, 0);
  EXPECT_NEAR(found->factor, 1.0 / 1.03, 0.005);
}

/// Named by five standard errors, however much noise is left.
TEST(ResidualPattern, FindsTheScaleOfASensor) {
  test::NoisyScene scene(40);
  for (const char* name : {"camera_fx", "camera_cy", "camera_z_scaling", "camera_z_offset"}) {
    std::erase(scene.names, name);
  }
  EXPECT_FALSE(pattern_in(scene));
  for (Sample& sample : scene.samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != "camera") continue;
      for (Feature& feature : seen.features) feature.point *= 1.03;
    }
  }
  const auto found = pattern_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "camera");
  EXPECT_EQ(found->course, ErrorCourse::scale);
  EXPECT_NEAR(found->factor, 1.0 / 1.03, 0.005);
}

TEST(ResidualPattern, IsNoneIfNothingIsLeftToExplain) {
  test::NoisyScene scene(40);
  scene.samples =
      test::exact_samples(test::scene_problem(), test::NoisyScene::span(scene.truth), 40);
  EXPECT_FALSE(pattern_in(scene));
}

}  // namespace
}  // namespace kinecal
