#include "kinecal/capture/tags/tag_layout.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "support/board_view.hpp"

namespace kinecal {
namespace {

using test::BoardView;
using testing::HasSubstr;

AprilTagSettings print_settings(int columns, int rows, double spacing) {
  AprilTagSettings settings;
  settings.columns = columns;
  settings.rows = rows;
  settings.size = 0.03;
  settings.spacing = spacing;
  return settings;
}

/// What is printed, and which settings say what.
struct PrintedTags {
  AprilTagSettings print = print_settings(5, 4, 0.3);
  int turns = 0;           ///< quarters
  bool rows_down = false;  ///< the first row is on top
  std::set<int> hidden = {};
  BoardView view = {};

  /// The corners that a finder with these settings reports.
  [[nodiscard]] std::vector<TargetCorner> corners(const AprilTagSettings& settings) const {
    std::vector<TargetCorner> all;
    const auto said = detail::grid_tags(settings);
    for (PlacedTag tag : detail::grid_tags(print)) {
      if (hidden.contains(tag.id)) continue;
      if (rows_down) {
        tag.centre.y() =
            (print.rows - 1) * print.size * (1.0 + print.spacing) + print.size - tag.centre.y();
      }
      for (int k = 0; k < 4; ++k) {
        TargetCorner corner;
        corner.id = 4 * tag.id + k;
        corner.pixel = view.pixel(detail::tag_corner(tag, (k + turns) % 4));
        corner.target = detail::tag_corner(said[static_cast<std::size_t>(tag.id)], k);
        all.push_back(corner);
      }
    }
    return all;
  }
  [[nodiscard]] detail::TagLayout layout(const AprilTagSettings& settings) const {
    auto seen = corners(settings);
    return detail::arrange_tags(settings, view.camera(), seen);
  }
};

TEST(TagLayout, TagsAreTakenAsTheyAreTurned) {
  for (const bool fisheye : {false, true}) {
    for (const int turns : {1, 2, 3}) {
      PrintedTags tags;
      tags.turns = turns;
      tags.view.fisheye = fisheye;
      auto seen = tags.corners(tags.print);
      const auto layout = detail::arrange_tags(tags.print, tags.view.camera(), seen);
      EXPECT_EQ(layout.fault, "");
      EXPECT_THAT(layout.note, HasSubstr(std::to_string(90 * turns) + " degrees against the grid"));
      for (const TargetCorner& corner : seen) {
        EXPECT_LT((tags.view.pixel(corner.target) - corner.pixel).norm(), 1e-6);
        EXPECT_EQ(corner.id % 4, corner.id - 4 * (corner.id / 4));
      }
    }
  }
}

TEST(TagLayout, RowsMayGoDown) {
  PrintedTags tags;
  tags.rows_down = true;
  auto seen = tags.corners(tags.print);
  EXPECT_THAT(detail::arrange_tags(tags.print, tags.view.camera(), seen).note,
              HasSubstr("first row is on top"));
  for (const TargetCorner& corner : seen) {
    EXPECT_LT((tags.view.pixel(corner.target) - corner.pixel).norm(), 1e-6);
  }
}

TEST(TagLayout, ATurnIsFoundFromTwoTags) {
  PrintedTags tags;
  tags.turns = 2;
  for (int id = 2; id < 20; ++id) tags.hidden.insert(id);
  EXPECT_THAT(tags.layout(tags.print).note, HasSubstr("180 degrees"));
}

TEST(TagLayout, NamesTheNumberOfColumns) {
  for (const int turns : {0, 2}) {
    PrintedTags tags;
    tags.turns = turns;
    EXPECT_THAT(tags.layout(print_settings(4, 5, 0.3)).fault, HasSubstr("write columns: 5"));
    EXPECT_THAT(tags.layout(print_settings(10, 2, 0.3)).fault, HasSubstr("write columns: 5"));
  }
  PrintedTags few;
  for (int id = 0; id < 20; id += 3) few.hidden.insert(id);
  EXPECT_THAT(few.layout(print_settings(6, 4, 0.3)).fault, HasSubstr("write columns: 5"));
}

TEST(TagLayout, NamesTheGap) {
  const PrintedTags tags{.print = print_settings(5, 4, 0.25)};
  EXPECT_THAT(tags.layout(print_settings(5, 4, 0.3)).fault, HasSubstr("write spacing: 0.25"));
}

TEST(TagLayout, SaysNothingOfAGridAsItsSettingsSay) {
  PrintedTags tags;
  for (const bool fisheye : {false, true}) {
    tags.view.fisheye = fisheye;
    EXPECT_EQ(tags.layout(tags.print).fault, "");
    EXPECT_EQ(tags.layout(tags.print).note, "");
  }
}

}  // namespace
}  // namespace kinecal
