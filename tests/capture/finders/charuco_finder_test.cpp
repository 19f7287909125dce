#include "kinecal/capture/finders/charuco_finder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/board_images.hpp"
#include "support/repetitions.hpp"

#ifdef KINECAL_HAVE_ARUCO
#include <opencv2/aruco/charuco.hpp>
#endif

namespace kinecal {
namespace {

using kinecal::test::facing;
using kinecal::test::mean_error;
using kinecal::test::Print;
using kinecal::test::Target;
using kinecal::test::view_of;
using ::testing::HasSubstr;

CharucoSettings board_of(int squares_x, int squares_y) {
  CharucoSettings settings;
  settings.squares_x = squares_x;
  settings.squares_y = squares_y;
  return settings;
}

#ifdef KINECAL_HAVE_ARUCO

constexpr int kCell = 96;  // pixels of a square in the drawing

/// A drawing of a board with a white margin of a quarter of a square.
Print print_of(const cv::Mat& drawing, const CharucoSettings& s) {
  return [drawing, s](double x, double y) {
    const double a = x / s.square_size, b = y / s.square_size;
    if (a < -0.25 || b < -0.25 || a > s.squares_x + 0.25 || b > s.squares_y + 0.25) return -1.0;
    const int u = static_cast<int>(std::floor(a * kCell)),
              v = static_cast<int>(std::floor(b * kCell));
    if (u < 0 || v < 0 || u >= drawing.cols || v >= drawing.rows) return 1.0;
    return drawing.at<std::uint8_t>(v, u) > 127 ? 1.0 : 0.0;
  };
}

cv::Ptr<cv::aruco::Dictionary> words() {
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
  return cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50);
#else
  return cv::makePtr<cv::aruco::Dictionary>(
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50));
#endif
}

/// A board as it is described: markers in the white squares, row by row.
cv::Mat drawn(const CharucoSettings& s) {
  cv::Mat board(s.squares_y * kCell, s.squares_x * kCell, CV_8UC1, cv::Scalar(255));
  const bool white_first = s.legacy && s.squares_y % 2 == 0;
  const int side = static_cast<int>(std::lround(kCell * s.marker_size / s.square_size));
  int id = s.first_id;
  for (int row = 0; row < s.squares_y; ++row) {
    for (int column = 0; column < s.squares_x; ++column) {
      const cv::Rect square(column * kCell, row * kCell, kCell, kCell);
      if (((column + row) % 2 == 0) != white_first) {
        board(square).setTo(0);
        continue;
      }
      cv::Mat marker;
      cv::aruco::drawMarker(words(), id++, side, marker, 1);
      const int gap = (kCell - side) / 2;
      marker.copyTo(board(cv::Rect(square.x + gap, square.y + gap, side, side)));
    }
  }
  return board;
}

Target target_of(const CharucoSettings& s, const cv::Mat& drawing, const Vector3<double>& at,
                 double tilt_x, double tilt_y, double roll) {
  return {print_of(drawing, s),
          facing(at, tilt_x, tilt_y, roll,
                 {s.squares_x * s.square_size / 2, s.squares_y * s.square_size / 2, 0.0})};
}

TEST(CharucoFinder, FindsCornersOfABoardToATenthOfAPixel) {
  const CharucoSettings s = board_of(5, 7);
  const cv::Mat drawing = drawn(s);
  const std::vector<double> rolls = {1.2, -1.6, 0.0, 2.8};
  for (int i = 0; i < test::repetitions(4, 2); ++i) {
    const double roll = rolls[static_cast<std::size_t>(i)];
    const Target target = target_of(s, drawing, {0, 0, 0.55}, 0.3, -0.3, roll);
    const Found found = CharucoFinder(s).find(view_of({target}));
    EXPECT_LT(mean_error(found, target), 0.1) << found.refusal;
    ASSERT_TRUE(found);
    EXPECT_EQ(found.observations[0].features.size(), 24u);
    EXPECT_EQ(found.observations[1].features[5].id, 5);
  }
}

#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR == 6
TEST(CharucoFinder, TheBoardIsTheOneThatOpenCvDraws) {
  for (const int rows : {6, 7}) {
    const CharucoSettings s = board_of(5, rows);
    cv::Mat drawing;
    cv::aruco::CharucoBoard::create(5, rows, 0.04F, 0.03F, words())
        ->draw({5 * kCell, rows * kCell}, drawing, 0, 1);
    const Target target = target_of(s, drawing, {0, 0, 0.55}, 0.2, 0.2, 0.1);
    EXPECT_LT(mean_error(CharucoFinder(s).find(view_of({target})), target), 0.1);
  }
}
#endif

TEST(CharucoFinder, ReadsBoardsOfOldWithTheirTopLeftWhite) {
  CharucoSettings s = board_of(5, 6);
  s.legacy = true;
  s.first_id = 3;
  const Target target = target_of(s, drawn(s), {0, 0, 0.55}, 0.2, 0.2, 0.1);
  EXPECT_LT(mean_error(CharucoFinder(s).find(view_of({target})), target), 0.1);
}

TEST(CharucoFinder, NamesSettingsThatTheMarkersContradict) {
  const CharucoSettings s = board_of(5, 7);
  const View view = view_of({target_of(s, drawn(s), {0, 0, 0.55}, 0.2, 0.2, 0.1)});
  for (const auto& [columns, rows] : {std::pair{7, 5}, {6, 7}, {4, 8}}) {
    EXPECT_THAT(CharucoFinder(board_of(columns, rows)).find(view).refusal,
                HasSubstr("squares in a row has them; write squares_x: 5"))
        << columns;
  }
  CharucoSettings old = board_of(5, 6);
  old.legacy = true;
  EXPECT_THAT(CharucoFinder(board_of(5, 6))
                  .find(view_of({target_of(old, drawn(old), {0, 0, 0.55}, 0.2, 0.2, 0.1)}))
                  .refusal,
              HasSubstr("write legacy: true"));
}

TEST(CharucoFinder, APartOfTheBoardIsEnough) {
  const CharucoSettings s = board_of(5, 7);
  const Target target = target_of(s, drawn(s), {0.2, 0.12, 0.5}, 0.2, 0.2, 0.3);
  const Found found = CharucoFinder(s).find(view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  EXPECT_LT(found.observations[0].features.size(), 24u);
  EXPECT_LT(mean_error(found, target), 0.1);
  CharucoSettings all = s;
  all.min_corners = 24;
  EXPECT_THAT(CharucoFinder(all).find(view_of({target})).refusal,
              HasSubstr("of 24 corners; at least 24 must be"));
}

TEST(CharucoFinder, BlurAndASecondBoardAreRefused) {
  CharucoSettings s = board_of(5, 7);
  const cv::Mat drawing = drawn(s);
  s.target.quality.max_edge_width = 3.0;
  const Target near = target_of(s, drawing, {0, 0, 0.4}, 0.1, 0.1, 1.6);
  EXPECT_THAT(CharucoFinder(s).find(view_of({near}, {.blur = 2.0})).refusal, HasSubstr("blurred"));
  const View two = view_of({target_of(s, drawing, {-0.14, 0, 0.6}, 0.1, 0.1, 0.1),
                            target_of(s, drawing, {0.14, 0, 0.6}, 0.1, 0.1, 0.1)});
  EXPECT_THAT(CharucoFinder(s).find(two).refusal, HasSubstr("is seen twice"));
}

TEST(CharucoFinder, AViewWithoutTheBoardIsRefused) {
  EXPECT_THAT(CharucoFinder(board_of(5, 7)).find(view_of({})).refusal,
              HasSubstr("seen at 0 of 24 corners"));
}

#else

TEST(CharucoFinder, WithoutOpenCvItNamesThePackage) {
  EXPECT_THAT(CharucoFinder(board_of(5, 7)).find({}).refusal, HasSubstr("libopencv-dev"));
}

#endif

TEST(CharucoFinder, ImpossibleBoardsAreRefused) {
  EXPECT_THROW(CharucoFinder(board_of(2, 7)), std::invalid_argument);
  CharucoSettings wide = board_of(5, 7);
  wide.marker_size = 0.05;
  EXPECT_THROW(CharucoFinder{wide}, std::invalid_argument);
  CharucoSettings unknown = board_of(5, 7);
  unknown.dictionary = "DICT_4X4_51";
  EXPECT_THROW(CharucoFinder{unknown}, std::invalid_argument);
}

}  // namespace
}  // namespace kinecal
