// Corners of checkerboards, grids of discs and ArUco markers, found by OpenCV's plug-in.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "kinecal/capture/boards/opencv_module.hpp"
#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// Why this program cannot find checkerboards; empty if it can.
[[nodiscard]] std::string chessboard_fault();

/// Why this program cannot find grids of discs; empty if it can.
[[nodiscard]] std::string circles_fault();

/// Why this program cannot find ArUco markers; empty if it can.
[[nodiscard]] std::string aruco_fault();

/// The inner corners of a board, row by row, in one of its orders; empty if there is no such board.
/// @param columns, rows  inner corners, at least 3
/// @param longest        side of the image, pixels; a larger one is searched at this reduced size
[[nodiscard]] std::vector<Eigen::Vector2d> find_chessboard(const GrayImage& image, int columns,
                                                           int rows, BoardSearch search,
                                                           double longest);

/// Refines corners between four squares to where the surrounding gradients meet.
/// @param reach  half the side of the window around a corner, pixels
void refine_corners(const GrayImage& image, int reach, std::vector<Eigen::Vector2d>& corners);

/// About the middles of the black discs of a grid, row by row, in one of its orders; empty if there is no
/// such grid.  Larger images than 1600 pixels are searched at reduced size.
/// @param columns, rows  discs of a row, and rows; at least 2
/// @param asymmetric     every other row is shifted by half a step
[[nodiscard]] std::vector<Eigen::Vector2d> find_circles(const GrayImage& image, int columns,
                                                        int rows, bool asymmetric);

/// Names of ArUco's dictionaries: "DICT_4X4_50" and so on.
[[nodiscard]] const std::vector<std::string>& marker_dictionaries();

/// The markers of an ArUco dictionary.
/// @param dictionary  one of marker_dictionaries()
[[nodiscard]] std::vector<Marker> find_markers(const GrayImage& image,
                                               const std::string& dictionary);

}  // namespace kinecal::detail
