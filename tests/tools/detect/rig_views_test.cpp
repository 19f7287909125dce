// Photographs of several cameras that were taken at once.
#include "kinecal/tools/detect/rig_views.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace kinecal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// A photograph in which a camera sees corners with these ids; -1: without.
Look photograph(const std::string& path, const std::vector<int>& ids) {
  Look look;
  look.source = path;
  Sample sample;
  sample.source = path;
  Observation board{"board", {}, {}}, seen{"finder", {}, CameraInfo{}};
  for (const int id : ids) {
    Feature corner{"board", {0.1 * id, 0.0, 0.0}};
    if (id >= 0) corner.id = id;
    board.features.push_back(corner);
    seen.features.push_back(corner);
  }
  sample.observations = {board, seen};
  look.samples = {sample};
  return look;
}

std::vector<int> ids_of(const Observation& seen) {
  std::vector<int> ids;
  for (const Feature& feature : seen.features) ids.push_back(feature.id.value_or(-1));
  return ids;
}

TEST(RigViews, OfOneNameAreOneSample) {
  std::vector<CameraLooks> rig = {
      {"left", {photograph("i/left/10.png", {0, 1}), photograph("i/left/9.png", {4, 5})}},
      {"right", {photograph("i/right/10.jpg", {1, 2}), photograph("i/right/11.jpg", {7})}}};
  const std::vector<Sample> samples = joined_views(rig);
  ASSERT_THAT(samples, SizeIs(3));
  EXPECT_EQ(samples[0].source, "i/left/9.png");
  EXPECT_EQ(samples[1].source, "i/left/10.png, i/right/10.jpg");
  EXPECT_EQ(samples[2].source, "i/right/11.jpg");
  EXPECT_EQ(samples[0].observation("right"), nullptr);
  EXPECT_THAT(ids_of(*samples[1].observation("board")), ElementsAre(0, 1, 2));
  EXPECT_THAT(ids_of(*samples[1].observation("left")), ElementsAre(0, 1));
  EXPECT_THAT(ids_of(*samples[1].observation("right")), ElementsAre(1, 2));
  EXPECT_THAT(rig[0].looks[0].samples, IsEmpty());
}

/// What the first finder saw in one photograph may be another target than in the other.
TEST(RigViews, OfTwoTargetsAreApart) {
  const auto of_target = [](Look look, const std::string& name) {
    look.samples[0].observations[0].sensor = name;
    for (Feature& corner : look.samples[0].observations[0].features) corner.frame = name + "_board";
    return look;
  };
  Look both = of_target(photograph("left/1.png", {0, 1}), "arm_a");
  both.samples.push_back(of_target(photograph("left/1.png", {0, 1}), "arm_b").samples[0]);
  std::vector<CameraLooks> rig = {
      {"left", {both}}, {"right", {of_target(photograph("right/1.png", {1, 2}), "arm_b")}}};
  const std::vector<Sample> samples = joined_views(rig);
  ASSERT_THAT(samples, SizeIs(2));
  EXPECT_EQ(samples[0].observation("right"), nullptr);
  EXPECT_EQ(samples[1].observation("arm_a"), nullptr);
  EXPECT_THAT(ids_of(*samples[1].observation("arm_b")), ElementsAre(0, 1, 2));
}

TEST(RigViews, OfFeaturesWithoutIdsMustBeTheSame) {
  std::vector<CameraLooks> same = {{"left", {photograph("left/1.png", {-1, -1})}},
                                   {"right", {photograph("right/1.png", {-1, -1})}}};
  EXPECT_THAT(joined_views(same), SizeIs(1));
  std::vector<CameraLooks> other = {{"left", {photograph("left/1.png", {-1, -1})}},
                                    {"right", {photograph("right/1.png", {-1})}}};
  EXPECT_THAT([&] { (void)joined_views(other); },
              testing::ThrowsMessage<SampleError>(HasSubstr("left/1.png: cameras see other")));
}

}  // namespace
}  // namespace kinecal
