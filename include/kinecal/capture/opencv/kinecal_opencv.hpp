// A plug-in with OpenCV's searches for boards and markers: what opencv_module.hpp loads.
//
// CMake builds it where libopencv-dev is installed (cmake/KinecalOpencv.cmake).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace kinecal::detail {

/// How to search for boards.  Of 240 boards of 5 x 4 to 9 x 6 corners in 640 x 480 pixels, some
/// blurred, `squares` found 185 and `sectors` 237; of 80 with 3 x 3, `squares` 80 and `sectors` 72.
enum class BoardSearch {
  sectors,  ///< by their corners: 60 ms for any image of 640 x 480 pixels
  squares  ///< by their squares: 1 ms if the board is there; seconds, more in larger images, if it is not
};

/// A square marker: its corners clockwise from its top left.
struct Marker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners = {};
};

/// Brightness, row by row.
struct GrayPixels {
  const std::uint8_t* data = nullptr;  ///< width * height
  int width = 0;
  int height = 0;
};

/// What the plug-in gives.  opencv_corners.hpp describes the functions.
struct OpencvModule {
  const char* version;  ///< of kinecal
  std::vector<Eigen::Vector2d> (*find_chessboard)(GrayPixels image, int columns, int rows,
                                                  BoardSearch search, double longest);
  void (*refine_corners)(GrayPixels image, int reach, std::vector<Eigen::Vector2d>& corners);
  std::vector<Eigen::Vector2d> (*find_circles)(GrayPixels image, int columns, int rows,
                                               bool asymmetric);
  /// @param dictionary  its place in marker_dictionaries(); the function is nullptr without OpenCV's module aruco
  std::vector<Marker> (*find_markers)(GrayPixels image, int dictionary);
};

}  // namespace kinecal::detail

/// The only symbol of the plug-in.
extern "C" const kinecal::detail::OpencvModule* kinecal_opencv();
