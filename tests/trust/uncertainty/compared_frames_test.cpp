#include "kinecal/trust/uncertainty/compared_frames.hpp"

#include <gtest/gtest.h>

#include "support/noisy_scene.hpp"

namespace kinecal::test {
namespace {

TEST(ComparedFrames, AreThoseOfTheFeaturesWithTheCameraLast) {
  NoisyScene scene(3);
  const auto frames = compared_frames(*scene.problem(scene.samples), scene.samples);
  ASSERT_TRUE(frames.has_value());
  EXPECT_EQ(frames->first.name(), "hand");
  EXPECT_EQ(frames->second.name(), "camera_optical_frame");
  EXPECT_FALSE(compared_frames(*scene.problem({}), {}).has_value());
}

}  // namespace
}  // namespace kinecal::test
