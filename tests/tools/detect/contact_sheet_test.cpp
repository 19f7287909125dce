// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "kinecal/files/images/read_image.hpp"

namespace kinecal {
namespace {

TEST(ContactSheet, AThumbnailIsTheMeanOfPixelsAndItsMarksStayWhereTheyWere) {
  GrayImage image(1280, 960, 100);
  for (int i = 0; i < 4; ++i) image(100 + i % 2, 60 + i / 2) = static_cast<std::uint8_t>(20 * i);
  // The middle of a square of four pixels is the middle of the one that it becomes.
  const Thumbnail small = thumbnail(image, {{100.5, 60.5, ""}}, "a.png", "");
  EXPECT_EQ(small.image.width, 640);
  EXPECT_EQ(small.image.height, 480);
  EXPECT_EQ(small.image(50, 30), 30);
  EXPECT_EQ(small.image(51, 30), 100);
  EXPECT_DOUBLE_EQ(small.marks[0].u, 50.0);
  EXPECT_DOUBLE_EQ(small.marks[0].v, 30.0);
}

TEST(ContactSheet, MarksOutsideAnImageAreLeftOut) {
  const Thumbnail small =
      thumbnail(GrayImage(8, 8), {{1e300, 0, ""}, {-5, 2, ""}}, "a.png", "a reason");
  EXPECT_FALSE(contact_sheet({small, small, small, small, small}).empty());
}

TEST(ContactSheet, MarksFarAwayDrawNoLinesForever) {
  std::vector<Mark> marks;
  for (int i = 0; i < 8; ++i) marks.push_back({10.0 * i, 1e12 * (i % 2), ""});
  const Thumbnail small = thumbnail(GrayImage(80, 80), marks, "a.png", "");
  EXPECT_FALSE(contact_sheet({small}).empty());
}

TEST(ContactSheet, WithoutAViewThereIsNone) {
  EXPECT_THROW((void)contact_sheet({}), std::invalid_argument);
}

#ifdef KINECAL_HAVE_PNG
TEST(ContactSheet, FiveViewsAreTwoRowsOfAPng) {
  const Thumbnail small = thumbnail(GrayImage(640, 240, 50), {}, "a.png", "");
  const GrayImage one = decode_image(contact_sheet({small}), "sheet");
  const GrayImage five = decode_image(contact_sheet(std::vector<Thumbnail>(5, small)), "sheet");
  EXPECT_GT(five.width, 3 * 640);
  EXPECT_GT(five.height, one.height + 240);
}
#endif

}  // namespace
}  // namespace kinecal
