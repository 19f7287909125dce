#include "kinecal/capture/tags/marker_tags.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "kinecal/capture/boards/opencv_corners.hpp"
#include "kinecal/capture/finders/april_tag_finder.hpp"
#include "support/board_images.hpp"

#ifdef KINECAL_HAVE_ARUCO
#include <opencv2/aruco.hpp>
#endif

namespace kinecal {
namespace {

using kinecal::test::Print;
using kinecal::test::Target;
using ::testing::HasSubstr;

TEST(MarkerTags, EachDictionaryHasItsNumberOfCells) {
  EXPECT_EQ(detail::marker_cells("DICT_4X4_50"), 6);
  EXPECT_EQ(detail::marker_cells("DICT_7X7_1000"), 9);
  EXPECT_EQ(detail::marker_cells("DICT_ARUCO_ORIGINAL"), 7);
  EXPECT_EQ(detail::marker_cells("DICT_APRILTAG_16h5"), 6);
  EXPECT_EQ(detail::marker_cells("DICT_APRILTAG_36h11"), 8);
  for (const std::string& name : detail::marker_dictionaries()) {
    EXPECT_TRUE(detail::is_marker_dictionary(name));
    EXPECT_GE(detail::marker_cells(name), 6) << name;
    EXPECT_LE(detail::marker_cells(name), 9) << name;
  }
  EXPECT_FALSE(detail::is_marker_dictionary("tag36h11"));
}

AprilTagSettings marker_settings() {
  AprilTagSettings settings;
  settings.family = "DICT_5X5_100";
  settings.tags = {{7, 0.08, {0, 0, 0}}};
  return settings;
}

TEST(MarkerTags, ABorderOfTwoBitsIsRefused) {
  AprilTagSettings settings = marker_settings();
  settings.border = 2;
  EXPECT_THROW(AprilTagFinder{settings}, std::invalid_argument);
}

#ifdef KINECAL_HAVE_ARUCO

/// A marker as OpenCV draws it, its middle at the origin, y up.
Print print_of(int id, double size) {
  constexpr int kCells = 7;
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
  const auto words = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
#else
  const auto words = cv::makePtr<cv::aruco::Dictionary>(
      cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100));
#endif
  cv::Mat drawing;
  cv::aruco::drawMarker(words, id, kCells, drawing, 1);
  return [=](double x, double y) {
    const double a = x / size + 0.5, b = 0.5 - y / size;
    if (a < -0.3 || b < -0.3 || a > 1.3 || b > 1.3) return -1.0;
    if (a < 0.0 || b < 0.0 || a >= 1.0 || b >= 1.0) return 1.0;
    return drawing.at<std::uint8_t>(static_cast<int>(b * kCells), static_cast<int>(a * kCells)) >
                   127
               ? 1.0
               : 0.0;
  };
}

Target marker_target(double tilt_x, double tilt_y, double roll) {
  return {print_of(7, 0.08),
          test::facing({0.02, 0.01, 0.4}, std::numbers::pi + tilt_x, tilt_y, roll, {0, 0, 0})};
}

TEST(MarkerTags, CornersOfASingleMarkerAreFoundToATenthOfAPixel) {
  for (const double roll : {0.0, 0.8, 2.5, -1.6}) {
    const Target target = marker_target(0.4, -0.3, roll);
    const Found found = AprilTagFinder(marker_settings()).find(test::view_of({target}));
    ASSERT_TRUE(found) << found.refusal;
    EXPECT_EQ(found.observations[0].features.size(), 4u);
    EXPECT_EQ(found.observations[0].features[0].id, 28);
    EXPECT_LT(test::mean_error(found, target), 0.1) << roll;
  }
}

TEST(MarkerTags, ThePoseOfASingleMarkerIsItsPlaceOnTheTarget) {
  AprilTagSettings settings = marker_settings();
  settings.target.corners = CornerKind::pose;
  const Target target = marker_target(0.5, -0.4, 0.9);
  const Found found = AprilTagFinder(settings).find(test::view_of({target}));
  ASSERT_TRUE(found) << found.refusal;
  const Feature& seen = found.observations[0].features.at(0);
  ASSERT_TRUE(seen.rotation);
  EXPECT_LT((seen.point - target.camera_T_board.translation).norm(), 1e-3);
  const Matrix3<double> off = *seen.rotation * target.camera_T_board.rotation.transpose();
  EXPECT_LT(log(off).norm(), 0.02);
}

TEST(MarkerTags, MarkersOfTheTargetThatAreMissingAreNamed) {
  AprilTagSettings settings = marker_settings();
  settings.tags[0].id = 8;
  const Found found = AprilTagFinder(settings).find(test::view_of({marker_target(0.4, -0.3, 0.0)}));
  EXPECT_FALSE(found);
  EXPECT_THAT(found.refusal, HasSubstr("tag 7 is seen, the target has tag 8"));
}

#endif

}  // namespace
}  // namespace kinecal
