#include "kinecal/capture/finders/april_tag_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/board_images.hpp"
#include "support/repetitions.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"
#endif

namespace kinecal {
namespace {

using kinecal::test::camera_640;
using kinecal::test::Exposure;
using kinecal::test::facing;
using kinecal::test::mean_error;
using kinecal::test::Print;
using kinecal::test::Target;
using kinecal::test::view_of;
using ::testing::HasSubstr;

constexpr double kTag = 0.05;     // as kTagSize
constexpr double kSpacing = 0.3;  // as kTagSpacing

AprilTagSettings grid(int columns, int rows) {
  AprilTagSettings settings;
  settings.columns = columns;
  settings.rows = rows;
  settings.size = kTag;
  settings.spacing = kSpacing;
  settings.target.frame = "tags";
  return settings;
}

#ifdef KINECAL_HAVE_APRILTAG

/// The target faces the camera: its y is up, its z towards the viewer.
Target target_of(const Print& print, int columns, int rows, const Vector3<double>& at,
                 double tilt_x, double tilt_y, double roll) {
  const Vector3<double> middle((columns - 0.25) * kTag * 0.65, (rows - 0.25) * kTag * 0.65, 0.0);
  return {print, facing(at, std::numbers::pi + tilt_x, tilt_y, roll, middle)};
}

TEST(AprilTagFinder, FindsCornersOfAGridToATenthOfAPixel) {
  const Print print = kinecal::test::tag_grid(4, 3);
  const std::vector<double> rolls = {1.0, -1.5, 0.0, 2.0, 3.0};
  for (int i = 0; i < test::repetitions(5, 2); ++i) {
    const double roll = rolls[static_cast<std::size_t>(i)];
    const Target target = target_of(print, 4, 3, {0.01, 0.0, 0.5}, 0.3, -0.4, roll);
    const Found found = AprilTagFinder(grid(4, 3)).find(view_of({target}));
    EXPECT_LT(mean_error(found, target), 0.1) << found.refusal;
    ASSERT_TRUE(found);
    EXPECT_EQ(found.observations[1].features.size(), 48u);
  }
}

TEST(AprilTagFinder, IdsAreFourTimesTheTagPlusTheCorner) {
  const Target target = target_of(kinecal::test::tag_grid(2, 2), 2, 2, {0, 0, 0.5}, 0, 0, 0);
  const Found found = AprilTagFinder(grid(2, 2)).find(view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  const Observation& held = found.observations[1];
  ASSERT_EQ(held.features.size(), 16u);
  EXPECT_EQ(held.features[6].id, 6);
  EXPECT_EQ(held.features[6].frame, "tags");
  EXPECT_TRUE(held.features[6].point.isApprox(Vector3<double>(2.3 * kTag, kTag, 0)));
  EXPECT_EQ(found.observations[0].features[6].id, 6);
}

TEST(AprilTagFinder, APartOfTheGridIsEnough) {
  const Target target =
      target_of(kinecal::test::tag_grid(4, 3), 4, 3, {0.2, 0.05, 0.45}, 0.2, 0.2, 0.1);
  const Found found = AprilTagFinder(grid(4, 3)).find(view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_LT(found.observations[0].features.size(), 48u);
  EXPECT_LT(mean_error(found, target), 0.1);
  AprilTagSettings all = grid(4, 3);
  all.min_tags = 12;
  EXPECT_THAT(AprilTagFinder(all).find(view_of({target})).refusal,
              HasSubstr("of 12 tags are seen, at least 12 must be"));
}

TEST(AprilTagFinder, ReadsTheWideBorderOfKalibr) {
  const Target target =
      target_of(kinecal::test::tag_grid(3, 2, 2), 3, 2, {0, 0, 0.4}, 0.2, 0.2, 0.1);
  AprilTagSettings settings = grid(3, 2);
  EXPECT_FALSE(AprilTagFinder(settings).find(view_of({target})));
  settings.border = 2;
  const Found found = AprilTagFinder(settings).find(view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_EQ(found.observations[0].features.size(), 24u);
  EXPECT_LT(mean_error(found, target), 0.1);
}

TEST(AprilTagFinder, ATagThatIsSeenTwiceIsRefused) {
  const Target target =
      target_of(kinecal::test::tag_grid(3, 2, 1, true), 3, 2, {0, 0, 0.5}, 0, 0.2, 0);
  EXPECT_THAT(AprilTagFinder(grid(3, 2)).find(view_of({target})).refusal,
              HasSubstr("tag 0 is seen twice"));
}

TEST(AprilTagFinder, SingleTagsHaveTheirOwnSizesAndPlacesAndOthersAreLeftAlone) {
  const Target target = target_of(kinecal::test::tag_grid(3, 2), 3, 2, {0, 0, 0.5}, 0.2, 0.2, 0.1);
  AprilTagSettings settings;
  settings.tags = {{4, kTag, {1.3 * kTag + kTag / 2, 1.3 * kTag + kTag / 2, 0.0}}};
  const Found found = AprilTagFinder(settings).find(view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  ASSERT_EQ(found.observations[0].features.size(), 4u);
  EXPECT_EQ(found.observations[0].features[0].id, 16);
  EXPECT_LT(mean_error(found, target), 0.1);
}

TEST(AprilTagFinder, BlurAndSmallTagsAreRefused) {
  const Print print = kinecal::test::tag_grid(2, 2);
  Exposure moving;
  moving.motion = 9;
  const Target near = target_of(print, 2, 2, {0, 0, 0.3}, 0, 0.1, 0);
  EXPECT_THAT(AprilTagFinder(grid(2, 2)).find(view_of({near}, moving)).refusal,
              HasSubstr("blurred"));
  const Target far = target_of(print, 2, 2, {0, 0, 1.5}, 0, 0.1, 0);
  EXPECT_THAT(AprilTagFinder(grid(2, 2)).find(view_of({far})).refusal, HasSubstr("too small"));
}

TEST(AprilTagFinder, ViewsWithoutTagsOrTooSmallForThemAreRefused) {
  EXPECT_THAT(AprilTagFinder(grid(2, 2)).find(view_of({})).refusal,
              HasSubstr("0 of 4 tags are seen"));
  View tiny;
  tiny.image = GrayImage(5, 5, 9);
  tiny.camera = camera_640();
  tiny.camera->width = tiny.camera->height = 5;
  EXPECT_THAT(AprilTagFinder(grid(2, 2)).find(tiny).refusal, HasSubstr("0 of 4 tags"));
}

#else

TEST(AprilTagFinder, WithoutLibapriltagItNamesThePackage) {
  EXPECT_THAT(AprilTagFinder(grid(2, 2)).find({}).refusal, HasSubstr("libapriltag-dev"));
}

#endif

TEST(AprilTagFinder, ImpossibleTargetsAreRefused) {
  EXPECT_THROW(AprilTagFinder(AprilTagSettings{}), std::invalid_argument);
  AprilTagSettings unknown = grid(2, 2);
  unknown.family = "tag37h11";
  EXPECT_THROW(AprilTagFinder{unknown}, std::invalid_argument);
  AprilTagSettings twice = grid(2, 2);
  twice.tags = {{3, 0.1, {1, 1, 0}}};
  EXPECT_THROW(AprilTagFinder{twice}, std::invalid_argument);
  AprilTagSettings flat = grid(2, 2);
  flat.size = 0.0;
  EXPECT_THROW(AprilTagFinder{flat}, std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
