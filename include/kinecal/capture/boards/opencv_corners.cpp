// Definitions of opencv_corners.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/opencv_corners.hpp"

#include <algorithm>

namespace kinecal::detail {
namespace {

GrayPixels pixels_of(const GrayImage& image) {
  return {image.pixels.data(), image.width, image.height};
}

}  // namespace

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

std::string chessboard_fault() {
  return opencv_fault("checkerboards");
}

std::string circles_fault() {
  return opencv_fault("grids of discs");
}

std::string aruco_fault() {
  const OpencvModule* const module = opencv_module();
  if (module == nullptr || module->find_markers != nullptr) return opencv_fault("markers of ArUco");
  return "finding markers of ArUco needs OpenCV with its module aruco: install "
         "libopencv-contrib-dev and build kinecal-opencv again";
}

std::vector<Eigen::Vector2d> find_chessboard(const GrayImage& image, int columns, int rows,
                                             BoardSearch search, double longest) {
  const OpencvModule* const module = opencv_module();
  if (module == nullptr) return {};
  return module->find_chessboard(pixels_of(image), columns, rows, search, longest);
}

void refine_corners(const GrayImage& image, int reach, std::vector<Eigen::Vector2d>& corners) {
  if (const OpencvModule* const module = opencv_module()) {
    module->refine_corners(pixels_of(image), reach, corners);
  }
}

std::vector<Eigen::Vector2d> find_circles(const GrayImage& image, int columns, int rows,
                                          bool asymmetric) {
  const OpencvModule* const module = opencv_module();
  if (module == nullptr) return {};
  return module->find_circles(pixels_of(image), columns, rows, asymmetric);
}

std::vector<Marker> find_markers(const GrayImage& image, const std::string& dictionary) {
  const OpencvModule* const module = opencv_module();
  if (module == nullptr || module->find_markers == nullptr) return {};
  const auto& names = marker_dictionaries();
  const auto number = std::find(names.begin(), names.end(), dictionary) - names.begin();
  return module->find_markers(pixels_of(image), static_cast<int>(number));
}

}  // namespace kinecal::detail
