// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "kinecal/files/images/read_image.hpp"

namespace kinecal {
namespace {

/// The only sheet of a few views.
std::string sheet(const std::vector<Thumbnail>& views) {
  const std::vector<std::string> all = contact_sheets(views);
  EXPECT_EQ(all.size(), 1u);
  return all.front();
}

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
  EXPECT_FALSE(sheet({small, small, small, small, small}).empty());
}

TEST(ContactSheet, MarksFarAwayDrawNoLinesForever) {
  std::vector<Mark> marks;
  for (int i = 0; i < 8; ++i) marks.push_back({10.0 * i, 1e12 * (i % 2), ""});
  const Thumbnail small = thumbnail(GrayImage(80, 80), marks, "a.png", "");
  EXPECT_FALSE(sheet({small}).empty());
}

/// So that three pixels show.
TEST(ContactSheet, ThumbnailsOfWideImagesAreAtLeast640PixelsWide) {
  for (const int width : {640, 641, 1279, 1280, 1281, 1920, 2448, 4032}) {
    const Thumbnail small = thumbnail(GrayImage(width, 16), {}, "a.png", "");
    EXPECT_GE(small.image.width, 640) << width;
    EXPECT_LT(small.image.width, 1280) << width;
  }
}

TEST(ContactSheet, LinesOfTheGridShrinkWithTheImage) {
  const Thumbnail small =
      thumbnail(GrayImage(1280, 960), {}, "a.png", "", {{100.5, 60.5, 200.5, 80.5}});
  ASSERT_EQ(small.grid.size(), 1u);
  EXPECT_DOUBLE_EQ(small.grid[0].u0, 50.0);
  EXPECT_DOUBLE_EQ(small.grid[0].v1, 40.0);
}

TEST(ContactSheet, LinesThatAreNoNumbersAreLeftOut) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Thumbnail small = thumbnail(GrayImage(80, 80), {{nan, 2, ""}}, "a.png", "",
                                    {{nan, 0, 1, 1}, {0, 0, 1e300, 1}, {5, 5, 60, 5}});
  EXPECT_FALSE(sheet({small}).empty());
}

TEST(ContactSheet, ManyViewsAreSeveralSheets) {
  const std::vector<Thumbnail> views(kViewsOfSheet + 1, thumbnail(GrayImage(8, 8), {}, "a", ""));
  EXPECT_EQ(contact_sheets(views).size(), 2u);
  EXPECT_EQ(sheet_name("out/sheet.png", 0), "out/sheet.png");
  EXPECT_EQ(sheet_name("out/sheet.png", 1), "out/sheet-2.png");
}

TEST(ContactSheet, WithoutAViewThereIsNone) {
  EXPECT_THROW((void)contact_sheets({}), std::invalid_argument);
}

#ifdef KINECAL_HAVE_PNG
TEST(ContactSheet, FiveViewsAreTwoRowsOfAPng) {
  const Thumbnail small = thumbnail(GrayImage(640, 240, 50), {}, "a.png", "");
  const GrayImage one = decode_image(sheet({small}), "sheet");
  const GrayImage five = decode_image(sheet(std::vector<Thumbnail>(5, small)), "sheet");
  EXPECT_GT(five.width, 3 * 640);
  EXPECT_GT(five.height, one.height + 240);
}
#endif

}  // namespace
}  // namespace kinecal
