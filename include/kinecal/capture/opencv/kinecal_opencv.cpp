// Definitions of kinecal_opencv.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/opencv/kinecal_opencv.hpp"

#include <algorithm>
#include <cstddef>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/version.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#ifdef KINECAL_HAVE_ARUCO
#include <opencv2/aruco.hpp>
#endif

namespace kinecal::detail {
namespace {

/// The pixels of an image; OpenCV does not write to them.
cv::Mat opencv_image(GrayPixels image) {
  return {image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.data)};
}

/// An image of which no side is longer than so many pixels.
struct ReducedImage {
  double reduction;  ///< pixels of the image in one of these
  cv::Mat pixels;

  ReducedImage(GrayPixels image, double longest)
      : reduction(std::max(1.0, std::max(image.width, image.height) / longest)),
        pixels(opencv_image(image)) {
    if (!(reduction > 1.0)) return;
    cv::Mat smaller;
    cv::resize(pixels, smaller, {}, 1.0 / reduction, 1.0 / reduction, cv::INTER_AREA);
    pixels = smaller;
  }

  /// Where points of these pixels are in the image; the centre of the first pixel is at 0 in either size.
  [[nodiscard]] std::vector<Eigen::Vector2d> in_image(const std::vector<cv::Point2f>& found) const {
    std::vector<Eigen::Vector2d> points;
    for (const cv::Point2f& p : found) {
      points.emplace_back((p.x + 0.5) * reduction - 0.5, (p.y + 0.5) * reduction - 0.5);
    }
    return points;
  }
};

std::vector<Eigen::Vector2d> find_chessboard(GrayPixels image, int columns, int rows,
                                             BoardSearch search, double longest) {
  const ReducedImage reduced(image, longest);
  cv::Mat searched = reduced.pixels;
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
  return there ? reduced.in_image(found) : std::vector<Eigen::Vector2d>();
}

void refine_corners(GrayPixels image, int reach, std::vector<Eigen::Vector2d>& corners) {
  if (corners.empty()) return;
  std::vector<cv::Point2f> points;
  for (const auto& c : corners) {
    points.emplace_back(static_cast<float>(c.x()), static_cast<float>(c.y()));
  }
  const cv::TermCriteria end(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 60, 1e-3);
  cv::cornerSubPix(opencv_image(image), points, {reach, reach}, {-1, -1}, end);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = {points[i].x, points[i].y};
}

/// Finds dark discs.
/// @param most  area of a disc that can be in a grid, pixels
cv::Ptr<cv::FeatureDetector> disc_detector(double most) {
  cv::SimpleBlobDetector::Params params;
  params.minArea = 12.0F;
  params.maxArea = static_cast<float>(most);
  params.minDistBetweenBlobs = 3.0F;
  params.filterByCircularity = false;
  params.filterByInertia = true;
  params.minInertiaRatio = 0.05F;  // of discs tilted by 70 degrees
  params.filterByConvexity = true;
  params.minConvexity = 0.85F;
  return cv::SimpleBlobDetector::create(params);
}

std::vector<Eigen::Vector2d> find_circles(GrayPixels image, int columns, int rows,
                                          bool asymmetric) {
  constexpr double kLongestSide = 1600.0;
  const ReducedImage reduced(image, kLongestSide);
  const cv::Mat& searched = reduced.pixels;
  const auto discs = disc_detector(static_cast<double>(searched.total()) / (columns * rows));
  const int kind = asymmetric ? cv::CALIB_CB_ASYMMETRIC_GRID : cv::CALIB_CB_SYMMETRIC_GRID;
  std::vector<cv::Point2f> found;
  for (const int how : {kind, kind | cv::CALIB_CB_CLUSTERING}) {
    if (cv::findCirclesGrid(searched, {columns, rows}, found, how, discs)) {
      return reduced.in_image(found);
    }
  }
  return {};
}

#ifdef KINECAL_HAVE_ARUCO

std::vector<Marker> find_markers(GrayPixels image, int dictionary) {
  const auto words = cv::makePtr<cv::aruco::Dictionary>(
#if CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR < 7
      *cv::aruco::getPredefinedDictionary(dictionary)
#else
      cv::aruco::getPredefinedDictionary(dictionary)
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

constexpr std::nullptr_t find_markers = nullptr;

#endif

}  // namespace
}  // namespace kinecal::detail

const kinecal::detail::OpencvModule* kinecal_opencv() {
  using namespace kinecal::detail;
  static const OpencvModule module = {KINECAL_VERSION, find_chessboard, refine_corners,
                                      find_circles, find_markers};
  return &module;
}
