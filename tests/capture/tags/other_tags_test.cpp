// A target of which no tag is found: the image shows tags of another kind.
#include "kinecal/capture/tags/other_tags.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/board_images.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include "support/tag_images.hpp"
#endif

namespace kinecal {
namespace {

#ifdef KINECAL_HAVE_APRILTAG

using kinecal::test::facing;
using kinecal::test::Print;
using kinecal::test::Target;
using kinecal::test::view_of;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

AprilTagSettings three_by_two() {
  AprilTagSettings settings;
  settings.columns = 3;
  settings.rows = 2;
  settings.size = test::kTagSize;
  settings.target.frame = "tags";
  return settings;
}

/// A grid of 3 x 2 tags in front of the camera.
View grid_view(int border) {
  const Vector3<double> middle(2.75 * test::kTagSize * 0.65, 1.75 * test::kTagSize * 0.65, 0.0);
  const Target target = {test::tag_grid(3, 2, border),
                         facing({0, 0, 0.5}, std::numbers::pi, 0.1, 0.2, middle)};
  return view_of({target});
}

TEST(OtherTags, AnotherBorderIsNamedWithItsKey) {
  const AprilTagFinder finder(three_by_two());
  EXPECT_THAT(finder.find(grid_view(2)).refusal,
              EndsWith("; 6 tags with a border of 2 bits are seen: write border: 2"));
}

TEST(OtherTags, AnotherFamilyIsNamedWithItsKey) {
  AprilTagSettings settings = three_by_two();
  settings.family = "tag25h9";
  EXPECT_THAT(AprilTagFinder(settings).find(grid_view(1)).refusal,
              EndsWith("; 6 tags of family tag36h11 are seen: write family: tag36h11"));
  EXPECT_THAT(AprilTagFinder(settings).find(grid_view(2)).refusal,
              EndsWith("are seen: write family: tag36h11, border: 2"));
}

TEST(OtherTags, OtherIdsAreNamedWithTheFirst) {
  AprilTagSettings settings = three_by_two();
  settings.first_id = 30;
  EXPECT_THAT(AprilTagFinder(settings).find(grid_view(1)).refusal,
              EndsWith("; tags 0 to 5 are seen, the target has tags 30 to 35: write first_id: 0"));
}

TEST(OtherTags, NothingIsSaidOfAnImageWithoutTags) {
  const AprilTagFinder finder(three_by_two());
  for (int image = 0; image < 5; ++image) {
    EXPECT_THAT(finder.find(view_of({})).refusal, Not(HasSubstr("write")));
  }
}

TEST(OtherTags, AreFoundAgainInLaterImages) {
  const AprilTagFinder finder(three_by_two());
  for (int image = 0; image < 5; ++image) {
    EXPECT_THAT(finder.find(grid_view(2)).refusal, EndsWith("write border: 2"));
  }
}

#endif

}  // namespace
}  // namespace kinecal
