// Wraps OpenCV: corners of checkerboards, and ArUco markers.
//
// OpenCV's core, imgproc, calib3d and aruco are linked directly: with these and their dependencies,
// 24 shared libraries, the program starts 4 to 5 ms later (4 ms without).  No header includes
// OpenCV, so a program that includes kinecal compiles without it.  Without aruco, only ChArUco
// boards are missing.  `-DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON` builds kinecal, and its Debian
// package, without OpenCV.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// Why this build cannot find checkerboards; empty if it can.
[[nodiscard]] std::string chessboard_fault();

/// Why this build cannot find ArUco markers; empty if it can.
[[nodiscard]] std::string aruco_fault();

/// How to search for boards.  Of 240 boards of 5 x 4 to 9 x 6 corners in 640 x 480 pixels, some
/// blurred, `squares` found 185 and `sectors` 237; of 80 with 3 x 3, `squares` 80 and `sectors` 72.
enum class BoardSearch {
  sectors,  ///< by their corners: 60 ms for any image of 640 x 480 pixels
  squares  ///< by their squares: 1 ms if the board is there; seconds, more in larger images, if it is not
};

/// The inner corners of a board, row by row, in one of its orders; empty if there is no such board.
/// @param columns, rows  inner corners, at least 3
/// @param longest        side of the image, pixels; a larger one is searched at this reduced size
[[nodiscard]] std::vector<Eigen::Vector2d> find_chessboard(const GrayImage& image, int columns,
                                                           int rows, BoardSearch search,
                                                           double longest);

/// Refines corners between four squares to where the surrounding gradients meet.
/// @param reach  half the side of the window around a corner, pixels
void refine_corners(const GrayImage& image, int reach, std::vector<Eigen::Vector2d>& corners);

/// A square marker: its corners clockwise from its top left.
struct Marker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners = {};
};

/// Names of ArUco's dictionaries: "DICT_4X4_50" and so on.
[[nodiscard]] const std::vector<std::string>& marker_dictionaries();

/// The markers of an ArUco dictionary.
/// @param dictionary  one of marker_dictionaries()
[[nodiscard]] std::vector<Marker> find_markers(const GrayImage& image,
                                               const std::string& dictionary);

}  // namespace kinecal::detail
