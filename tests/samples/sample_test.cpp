#include "kinecal/samples/sample.hpp"

#include <gtest/gtest.h>

namespace kinecal {
namespace {

TEST(Sample, FindsPositionsByTheNamesOfTheirJoints) {
  Sample sample;
  sample.joint_names = {"elbow", "wrist", "lift"};
  sample.joint_positions = {0.1, 0.2, 0.3};
  EXPECT_EQ(sample.position("elbow"), 0.1);
  EXPECT_EQ(sample.position("lift"), 0.3);
  EXPECT_EQ(sample.position("elbo"), std::nullopt);
  EXPECT_EQ(Sample().position("elbow"), std::nullopt);
}

TEST(Sample, FindsWhatASensorObserved) {
  Sample sample;
  sample.observations = {{"arm", {}, {}}, {"camera", {{"frame", {1, 2, 3}}}, {}}};
  ASSERT_NE(sample.observation("camera"), nullptr);
  EXPECT_EQ(sample.observation("camera"), &sample.observations[1]);
  EXPECT_EQ(sample.observation("arm"), &sample.observations[0]);
  EXPECT_EQ(sample.observation("eye"), nullptr);
}

}  // namespace
}  // namespace kinecal
