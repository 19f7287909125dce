// Definitions of opencv_corners.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/opencv_corners.hpp"

#include <algorithm>
#include <cmath>

#ifdef KINECAL_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/imgproc.hpp>
#endif
#ifdef KINECAL_HAVE_ARUCO
#include <opencv2/aruco.hpp>
#endif

namespace kinecal::detail {

[[nodiscard]] std::string opencv_missing(const std::string& what) {
  return "this kinecal was built without OpenCV, which finds " + what +
         "; install libopencv-dev and build it again";
}

/// ArUco numbers its dictionaries in this order.
const std::vector<std::string>& marker_dictionaries() {
  static const std::vector<std::string> names = {
      "DICT_4X4_50",         "DICT_4X4_100",       "DICT_4X4_250",       "DICT_4X4_1000",
      "DICT_5X5_50",         "DICT_5X5_100",       "DICT_5X5_250",       "DICT_5X5_1000",
      "DICT_6X6_50",         "DICT_6X6_100",       "DICT_6X6_250",       "DICT_6X6_1000",
      "DICT_7X7_50",         "DICT_7X7_100",       "DICT_7X7_250",       "DICT_7X7_1000",
      "DICT_ARUCO_ORIGINAL", "DICT_APRILTAG_16h5", "DICT_APRILTAG_25h9", "DICT_APRILTAG_36h10",
      "DICT_APRILTAG_36h11"};
  return names;
}

#ifdef KINECAL_HAVE_OPENCV

std::string chessboard_fault() {
  return "";
}

/// The pixels of an image; OpenCV does not write to them.
[[nodiscard]] cv::Mat opencv_image(const GrayImage& image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data())};
}

std::vector<Eigen::Vector2d> find_chessboard(const GrayImage& image, int columns, int rows,
                                             BoardSearch search, double longest) {
  const double shrink = std::max(1.0, std::max(image.width, image.height) / longest);
  cv::Mat searched = opencv_image(image);
  if (shrink > 1.0) {
    cv::Mat smaller;
    cv::resize(searched, smaller, {}, 1.0 / shrink, 1.0 / shrink, cv::INTER_AREA);
    searched = smaller;
  }
  if (search == BoardSearch::squares) {  // noise has outlines: thousands of them take minutes
    constexpr double kSmooth = 1.0;      // pixels
    cv::Mat smooth;
    cv::GaussianBlur(searched, smooth, {0, 0}, kSmooth);
    searched = smooth;
  }
  std::vector<cv::Point2f> found;
  const int usual =
      cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK;
  const cv::Size size(columns, rows);
  const bool there =
      search == BoardSearch::squares
          ? cv::findChessboardCorners(searched, size, found, usual)
          : cv::findChessboardCornersSB(searched, size, found, cv::CALIB_CB_NORMALIZE_IMAGE);
  if (!there) return {};
  std::vector<Eigen::Vector2d> corners;
  for (const cv::Point2f& p : found) {  // the centre of the first pixel is at 0 in either size
    corners.emplace_back((p.x + 0.5) * shrink - 0.5, (p.y + 0.5) * shrink - 0.5);
  }
  return corners;
}

void refine_corners(const GrayImage& image, int reach, std::vector<Eigen::Vector2d>& corners) {
  if (corners.empty()) return;
  std::vector<cv::Point2f> points;
  for (const auto& c : corners) {
    points.emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
  }
  const cv::TermCriteria end(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3);
  cv::cornerSubPix(opencv_image(image), points, {reach, reach}, {-1, -1}, end);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = {points[i].x, points[i].y};
}

#else

std::string chessboard_fault() {
  return opencv_missing("checkerboards");
}

std::vector<Eigen::Vector2d> find_chessboard(const GrayImage&, int, int, BoardSearch, double) {
  return {};
}

void refine_corners(const GrayImage&, int, std::vector<Eigen::Vector2d>&) {}

#endif

#ifdef KINECAL_HAVE_ARUCO

std::string aruco_fault() {
  return "";
}

std::vector<Marker> find_markers(const GrayImage& image, const std::string& dictionary) {
  const auto& names = marker_dictionaries();
  const auto number =
      static_cast<int>(std::find(names.begin(), names.end(), dictionary) - names.begin());
  const auto words = cv::makePtr<cv::aruco::Dictionary>(
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
      *cv::aruco::getPredefinedDictionary(number)
#else
      cv::aruco::getPredefinedDictionary(number)
#endif
  );
  std::vector<std::vector<cv::Point2f>> found;
  std::vector<int> ids;
  cv::aruco::detectMarkers(opencv_image(image), words, found, ids);
  std::vector<Marker> markers;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Marker marker{ids[i], {}};
    for (std::size_t k = 0; k < 4; ++k) marker.corners[k] = {found[i][k].x, found[i][k].y};
    markers.push_back(marker);
  }
  return markers;
}

#else

std::string aruco_fault() {
  return opencv_missing("ChArUco boards, with its module aruco");
}

std::vector<Marker> find_markers(const GrayImage&, const std::string&) {
  return {};
}

#endif

}  // namespace kinecal::detail
