// Definitions of opencv_circles.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/opencv_circles.hpp"

#include <algorithm>

#ifdef KINECAL_HAVE_OPENCV
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace kinecal::detail {

#ifdef KINECAL_HAVE_OPENCV

std::string circles_fault() {
  return "";
}

/// Finds dark discs.
/// @param most  area of a disc that can be in a grid, pixels
[[nodiscard]] cv::Ptr<cv::FeatureDetector> disc_detector(double most) {
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

std::vector<Eigen::Vector2d> find_circles(const GrayImage& image, int columns, int rows,
                                          bool asymmetric) {
  constexpr double kLongestSide = 1600.0;
  const double shrink = std::max(1.0, std::max(image.width, image.height) / kLongestSide);
  cv::Mat searched(image.height, image.width, CV_8UC1,
                   const_cast<std::uint8_t*>(image.pixels.data()));
  if (shrink > 1.0) {
    cv::Mat smaller;
    cv::resize(searched, smaller, {}, 1.0 / shrink, 1.0 / shrink, cv::INTER_AREA);
    searched = smaller;
  }
  const auto discs = disc_detector(static_cast<double>(searched.total()) / (columns * rows));
  const int kind = asymmetric ? cv::CALIB_CB_ASYMMETRIC_GRID : cv::CALIB_CB_SYMMETRIC_GRID;
  std::vector<cv::Point2f> found;
  for (const int how : {kind, kind | cv::CALIB_CB_CLUSTERING}) {
    if (!cv::findCirclesGrid(searched, {columns, rows}, found, how, discs)) continue;
    std::vector<Eigen::Vector2d> centres;
    for (const cv::Point2f& p : found) {
      centres.emplace_back((p.x + 0.5) * shrink - 0.5, (p.y + 0.5) * shrink - 0.5);
    }
    return centres;
  }
  return {};
}

#else

std::string circles_fault() {
  return "this kinecal was built without OpenCV, which finds grids of discs; install libopencv-dev "
         "and "
         "build it again";
}

std::vector<Eigen::Vector2d> find_circles(const GrayImage&, int, int, bool) {
  return {};
}

#endif

}  // namespace kinecal::detail
