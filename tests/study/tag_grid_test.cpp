#include "kinecal/study/tag_grid.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace kinecal {
namespace {

#ifdef KINECAL_HAVE_APRILTAG
TEST(TagGrid, TagsHaveBlackBordersAndGaps) {
  const GrayImage picture = tag_grid_picture(3, 2);
  ASSERT_EQ(picture.width, 3 * 10 + 2);
  ASSERT_EQ(picture.height, 2 * 10 + 2);
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 2; ++row) {
      const int left = 2 + 10 * column, top = 2 + 10 * row;
      for (int i = 0; i < kPlainTags.tag(); ++i) {
        EXPECT_LT(picture(left + i, top), 50);
        EXPECT_LT(picture(left + i, top + 7), 50);
        EXPECT_LT(picture(left, top + i), 50);
        EXPECT_LT(picture(left + 7, top + i), 50);
      }
      EXPECT_GT(picture(left - 1, top + 3), 200);
      EXPECT_GT(picture(left + 8, top + 3), 200);
    }
  }
}

TEST(TagGrid, KalibrsSquaresTouchTheCornersOfTagsWithAWideBorder) {
  const GrayImage picture = tag_grid_picture(2, 1, kKalibrTags);
  ASSERT_EQ(picture.width, 2 * 13 - 3 + 12);
  ASSERT_EQ(picture.height, 10 + 12);
  EXPECT_LT(picture(5, 5), 50) << "a square";
  EXPECT_LT(picture(6, 6), 50) << "a tag";
  EXPECT_GT(picture(6, 5), 200);
  EXPECT_GT(picture(5, 6), 200);
  for (int i = 0; i < 10; ++i) EXPECT_LT(picture(6 + i, 7), 50) << "the second row of the border";
  EXPECT_LT(picture(16, 16), 50) << "the square between both tags";
  EXPECT_GT(picture(2, 2), 200) << "the margin";
}

TEST(TagGrid, TheFirstTagIsAtTheBottomLeft) {
  const GrayImage one = tag_grid_picture(1, 1), four = tag_grid_picture(2, 2);
  for (int v = 0; v < 10; ++v) {
    for (int u = 0; u < 10; ++u) EXPECT_EQ(one(u, v), four(u, v + 10));
  }
  EXPECT_THROW(static_cast<void>(tag_grid_picture(0, 2)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(tag_grid_picture(100, 100)), std::invalid_argument);
}
#else
TEST(TagGrid, NeedsLibapriltag) {
  EXPECT_THROW(static_cast<void>(tag_grid_picture(1, 1)), std::runtime_error);
}
#endif

}  // namespace
}  // namespace kinecal
