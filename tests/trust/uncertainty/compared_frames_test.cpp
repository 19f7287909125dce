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

TEST(ComparedFrames, AreThoseOfEachCamera) {
  NoisyScene scene(3);
  const auto problem =
      make_problem(mobile_manipulator(), "base_link", table_with_units(), kSceneFrames);
  problem->add_built_in(ChainPoint{}, {"arm", "hand"});
  problem->add_built_in(DepthCamera{}, {"camera", "camera_optical_frame"});
  problem->add_built_in(DepthCamera{}, {"second", "base_link"});
  problem->add_built_in("points", PointToPoint{}, {"camera", "arm"}, {});
  problem->add_built_in("again", PointToPoint{}, {"camera", "arm"}, {});
  problem->add_built_in("more", PointToPoint{}, {"second", "arm"}, {});
  for (Sample& sample : scene.samples) {
    Observation seen = *sample.observation("camera");
    seen.sensor = "second";
    for (Feature& feature : seen.features) feature.frame = "base_link";
    sample.observations.push_back(seen);
    problem->add_sample(sample);
  }
  const std::vector<ComparedFrames> frames = compared_frames(*problem, scene.samples);
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].in.name(), "camera_optical_frame");
  EXPECT_EQ(frames[1].frame.name(), "hand");
  EXPECT_EQ(frames[1].in.name(), "base_link");
}

}  // namespace
}  // namespace kinecal::test
