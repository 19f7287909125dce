// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/contact_sheet.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "kinecal/files/checksum.hpp"
#include "kinecal/files/images/png_bytes.hpp"

namespace kinecal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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

TEST(ContactSheet, GoesOnAfterTheViewsOfAnEarlierOne) {
  const auto view = [](const std::string& name) {
    return thumbnail(GrayImage(8, 8), {{2, 2, ""}}, name, "");
  };
  std::vector<Thumbnail> first;
  for (std::size_t i = 0; i + 1 < kViewsOfSheet; ++i) first.push_back(view("a</figure>\n.png"));
  const auto earlier = views_of_sheet(sheet(first));
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->size(), first.size()) << "a name is no end of a view";
  const std::vector<Thumbnail> more = {view("b.png"), view("c.png")};
  const std::vector<std::string> both = contact_sheets(more, *earlier);
  std::vector<Thumbnail> all = first;
  all.insert(all.end(), more.begin(), more.end());
  EXPECT_EQ(both, contact_sheets(all));
  EXPECT_EQ(both.size(), 2u);
  EXPECT_FALSE(views_of_sheet("<html></html>"));
  EXPECT_FALSE(views_of_sheet(sheet(first) + "more"));
}

TEST(ContactSheet, MarksFarOutsideAnImageAreLeftOut) {
  const Thumbnail small =
      thumbnail(GrayImage(8, 8), {{1e300, 0, ""}, {-5, 2, ""}}, "a.png", "a reason");
  EXPECT_THAT(sheet({small}), AllOf(HasSubstr("M-8.5 2.5h2"), Not(HasSubstr("000000"))));
  std::vector<Mark> marks;
  for (int i = 0; i < 8; ++i) marks.push_back({10.0 * i, 1e12 * (i % 2), ""});
  EXPECT_THAT(sheet({thumbnail(GrayImage(80, 80), marks, "a.png", "")}), Not(HasSubstr("order\"")));
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
  EXPECT_THAT(sheet({small}), AllOf(HasSubstr(R"(<path class="grid" d="M5.5 5.5L60.5 5.5"/>)"),
                                    Not(HasSubstr("d=\"M0")), Not(HasSubstr("000000"))));
}

TEST(ContactSheet, ManyViewsAreSeveralSheets) {
  const std::vector<Thumbnail> views(kViewsOfSheet + 1, thumbnail(GrayImage(8, 8), {}, "a", ""));
  const std::vector<std::string> sheets = contact_sheets(views);
  ASSERT_EQ(sheets.size(), 2U);
  EXPECT_THAT(sheets[0], AllOf(HasSubstr("<figcaption>24  a  0 found<"), Not(HasSubstr(">25  a"))));
  EXPECT_THAT(sheets[1], AllOf(HasSubstr("<figcaption>25  a  0 found<"), Not(HasSubstr(">24  a"))));
  EXPECT_EQ(sheet_name("out/sheet.html", 0), "out/sheet.html");
  EXPECT_EQ(sheet_name("out/sheet.html", 1), "out/sheet-2.html");
}

/// As commands have it that were written for sheets of that kind.
TEST(ContactSheet, ANameOfAPngIsThatOfThePage) {
  EXPECT_EQ(sheet_name("out/sheet.png", 0), "out/sheet.html");
  EXPECT_EQ(sheet_name("out/sheet.png", 2), "out/sheet-3.html");
}

TEST(ContactSheet, HasTheImageAndWhatWasFoundInIt) {
  GrayImage image(100, 80, 50);
  image(3, 4) = 200;
  const std::vector<Mark> marks = {
      {10, 20, "7", 0.3}, {30, 20, "8", 0.4}, {50, 25, "9", 5.0, true}};
  const std::string found = sheet({thumbnail(image, marks, "a.png", "", {{10, 20, 50, 20}})});
  EXPECT_THAT(found, HasSubstr("base64," + base64(detail::png_bytes(image)) + "\""));
  EXPECT_THAT(found, HasSubstr(R"(viewBox="0 0 100 80")"));
  EXPECT_THAT(found, HasSubstr("<figcaption>1  a.png  2 found, 1 dropped, rms 0.35 px<"));
  EXPECT_THAT(found,
              HasSubstr(R"(class="found" d="M6.5 20.5h2M12.5 20.5h2M10.5 16.5v2M10.5 22.5v2")"));
  EXPECT_THAT(found, HasSubstr("<title>7</title>"));
  EXPECT_THAT(found, HasSubstr(R"(class="dropped" x="44.5" y="19.5" width="12" height="12")"));
  EXPECT_THAT(found, HasSubstr(R"(class="first" x="3.5" y="13.5" width="14" height="14")"));
  EXPECT_THAT(found, HasSubstr(R"(class="first" d="M17.5 20.5L50.5 20.5")"));  // twice the way
  EXPECT_THAT(found, Not(HasSubstr("<figure class=\"refused\"")));
}

TEST(ContactSheet, WithoutAGridNeighboursAreJoined) {
  std::vector<Mark> marks;
  for (const double u : {10.0, 20.0, 30.0, 70.0, 80.0}) marks.push_back({u, 20, ""});
  const std::string found = sheet({thumbnail(GrayImage(100, 80), marks, "a.png", "")});
  EXPECT_THAT(found, HasSubstr(R"(class="order" d="M10.5 20.5L20.5 20.5")"));
  EXPECT_THAT(found, HasSubstr(R"(class="order" d="M70.5 20.5L80.5 20.5")"));
  EXPECT_THAT(found, Not(HasSubstr("M30.5 20.5L70.5 20.5")));
}

TEST(ContactSheet, ARefusedViewHasItsReason) {
  const std::string refused =
      sheet({thumbnail(GrayImage(8, 8), {{2, 2, ""}}, "<b>.png", "squares < 8 pixels")});
  EXPECT_THAT(refused, HasSubstr("<figure class=\"refused\">"));
  EXPECT_THAT(refused, HasSubstr("1  &lt;b&gt;.png<br>squares &lt; 8 pixels</figcaption>"));
  EXPECT_THAT(refused, Not(HasSubstr("<b>")));
}

TEST(ContactSheet, WithoutAViewThereIsNone) {
  EXPECT_THROW((void)contact_sheets({}), std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
