// SPDX-License-Identifier: Apache-2.0
#include "kinecal/trust/recording_change.hpp"

#include <gtest/gtest.h>

#include <random>

#include "support/noisy_scene.hpp"

namespace kinecal {
namespace {

std::optional<RecordingChange> change_in(test::NoisyScene& scene) {
  scene.solve();
  const FreeSet free = scene.free();
  const auto evaluator = scene.solved().evaluator(free);
  const LinearFit fit = scene.linear(*evaluator);
  return recording_change(scene.solved(), free, fit, each_its_own(scene.samples.size()));
}

/// Moves a joint of all samples from one on: it slipped.
void slip(test::NoisyScene& scene, const char* joint, std::size_t from, double by) {
  test::misread(scene, joint, [=](std::size_t s, double) { return s < from ? 0.0 : -by; });
}

TEST(RecordingChange, IsNoneInSamplesAsTheyShouldBe) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    test::NoisyScene scene(20, seed);
    EXPECT_FALSE(change_in(scene)) << seed;
  }
}

TEST(RecordingChange, OfAJointIsFoundWithItsPlace) {
  test::NoisyScene scene(40);
  slip(scene, "elbow", 25, 0.03);
  const auto found = change_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->sample, 25);
  EXPECT_LT(found->noise_left, 0.3);
}

TEST(RecordingChange, ThatIsADriftIsFoundWithItsSize) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow",
                [](std::size_t s, double) { return -0.04 * static_cast<double>(s) / 39.0; });
  const auto found = change_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_TRUE(found->drifts);
  EXPECT_NEAR(found->radians, 0.04, 0.004);
  EXPECT_LT(found->noise_left, 0.4);
}

/// In poses sorted by a joint, an error that depends on the joint looks like a drift.
TEST(RecordingChange, SaysIfTheOrderOfSamplesIsThatOfTheirPoses) {
  test::NoisyScene scene(40);
  scene.solve();
  const RecordingChange drift{.owner = "elbow", .drifts = true},
      step{.owner = "elbow", .sample = 20};
  EXPECT_FALSE(follows_poses(scene.solved(), drift, scene.samples));
  EXPECT_FALSE(follows_poses(scene.solved(), step, scene.samples));
  std::sort(scene.samples.begin(), scene.samples.end(), [](const Sample& a, const Sample& b) {
    return a.position("elbow").value() < b.position("elbow").value();
  });
  EXPECT_TRUE(follows_poses(scene.solved(), drift, scene.samples));
}

TEST(RecordingChange, OfTheLastSamplesIsABadCapture) {
  test::NoisyScene scene(40);
  slip(scene, "elbow", 39, 0.03);
  EXPECT_FALSE(change_in(scene));
}

/// A third of the samples, here and there, has another elbow.
TEST(RecordingChange, OfSamplesHereAndThereIsFoundWithThem) {
  test::NoisyScene scene(40);
  test::misread(scene, "elbow", [](std::size_t s, double) { return s % 3 == 0 ? -0.03 : 0.0; });
  const auto found = change_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_EQ(found->here_and_there.size(), 14u);
}

/// A joint that does not repeat is no two joints.
TEST(RecordingChange, IsNoneOfAJointThatScatters) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    test::NoisyScene scene(40, seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> scatter(0.0, 0.02);
    test::misread(scene, "elbow", [&](std::size_t, double) { return scatter(random); });
    EXPECT_FALSE(change_in(scene)) << seed;
  }
}

TEST(RecordingChange, OfAPartInTheMiddleIsFoundWithItsEnds) {
  test::NoisyScene scene(48);
  test::misread(scene, "elbow",
                [](std::size_t s, double) { return s >= 15 && s < 33 ? -0.03 : 0.0; });
  const auto found = change_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "elbow");
  EXPECT_NEAR(found->sample, 15, 3);
  EXPECT_NEAR(found->end, 33, 3);
  EXPECT_LT(found->noise_left, 0.6);
}

TEST(RecordingChange, HereAndThereIsThatOfTwoRobots) {
  test::NoisyScene scene(40);
  for (const char* joint : {"elbow", "shoulder_lift"}) {
    test::misread(scene, joint, [](std::size_t s, double) { return s % 2 == 0 ? 0.0 : -0.02; });
  }
  const auto found = change_in(scene);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->owner, "") << "the zeros of all joints";
  EXPECT_EQ(found->here_and_there.size(), 20u);
  EXPECT_LT(found->noise_left, 0.5);
}

}  // namespace
}  // namespace kinecal
