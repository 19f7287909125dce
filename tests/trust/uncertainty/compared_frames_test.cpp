#include "kinecal/trust/uncertainty/compared_frames.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal::test {
namespace {

TEST(ComparedFrames, AreThoseOfTheFeaturesWithTheCameraLast) {
  NoisyScene scene(3);
  const auto frames = compared_frames(*scene.problem(scene.samples), scene.samples);
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].frame.name(), "hand");
  EXPECT_EQ(frames[0].in.name(), "camera_optical_frame");
  EXPECT_TRUE(compared_frames(*scene.problem({}), {}).empty());
}

}  // namespace
}  // namespace kinecal::test
