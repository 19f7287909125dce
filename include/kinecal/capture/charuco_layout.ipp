// Where the markers of a ChArUco board are, and whether a view contradicts it: for charuco_finder.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/capture/board_fit.hpp"
#include "kinecal/capture/charuco_finder.hpp"
#include "kinecal/capture/opencv_corners.hpp"

namespace kinecal::detail {

/// Column and row.
using SquarePlace = std::pair<int, int>;

/// The squares with markers, in the order of their ids: row by row from the top left.
[[nodiscard]] inline std::vector<SquarePlace> marker_places(const CharucoSettings& s) {
  const int white = s.legacy && s.squares_y % 2 == 0 ? 0 : 1;
  std::vector<SquarePlace> places;
  for (int row = 0; row < s.squares_y; ++row) {
    for (int column = 0; column < s.squares_x; ++column) {
      if ((column + row) % 2 == white) places.emplace_back(column, row);
    }
  }
  return places;
}

/// The corners of markers where a board of some layout has them, in squares.
[[nodiscard]] inline std::vector<TargetCorner> marker_corners(
    const std::map<SquarePlace, Marker>& markers, const CharucoSettings& layout) {
  CharucoSettings board = layout;
  board.squares_y += 100;  // as many rows as it takes, odd or even as before
  const std::vector<SquarePlace> places = marker_places(board);
  const double gap = 0.5 * (1.0 - board.marker_size / board.square_size);
  std::vector<TargetCorner> corners;
  for (const auto& [unused, marker] : markers) {
    const int number = marker.id - board.first_id;
    if (number < 0 || number >= static_cast<int>(places.size())) return {};
    const auto& [column, row] = places[static_cast<std::size_t>(number)];
    for (std::size_t k = 0; k < 4; ++k) {
      const double x = k == 1 || k == 2 ? 1.0 - gap : gap, y = k >= 2 ? 1.0 - gap : gap;
      TargetCorner corner;
      corner.id = 4 * number + static_cast<int>(k);
      corner.pixel = marker.corners[k];
      corner.target = {column + x, row + y, 0.0};
      corners.push_back(corner);
    }
  }
  return corners;
}

/// The share of markers' corners that a layout has in the wrong place; one if most are.
[[nodiscard]] inline double wrong_share(const std::map<SquarePlace, Marker>& markers,
                                        const CharucoSettings& layout, const CameraInfo& camera) {
  const BoardFit fit = fit_board(marker_corners(markers, layout), camera);
  if (fit.off.empty() || !fit.agrees()) return 1.0;
  return fit.wrong() / static_cast<double>(fit.off.size());
}

/// Why the settings of a board contradict its markers, with those that agree; empty if they do not,
/// or if no others do.
[[nodiscard]] inline std::string charuco_layout_fault(const std::map<SquarePlace, Marker>& markers,
                                                      const CharucoSettings& settings,
                                                      const CameraInfo& camera) {
  constexpr std::size_t kEnough = 4;  // markers: of two rows, as a rule
  constexpr double kContradicts = 0.15, kAgrees = 0.05;
  constexpr int kMost = 30;
  if (markers.size() < kEnough || wrong_share(markers, settings, camera) <= kContradicts) return "";
  std::vector<CharucoSettings> others;
  for (int columns = 3; columns <= kMost; ++columns) {
    for (const bool legacy : {false, true}) {
      CharucoSettings other = settings;
      other.squares_x = columns;
      other.legacy = legacy;
      if (legacy != settings.legacy && settings.squares_y % 2 == 1) continue;  // the same
      if (wrong_share(markers, other, camera) <= kAgrees) others.push_back(other);
    }
  }
  if (others.size() != 1) return "";
  const CharucoSettings& right = others.front();
  std::string keys;
  if (right.squares_x != settings.squares_x) {
    keys = "squares_x: " + std::to_string(right.squares_x);
  }
  if (right.legacy != settings.legacy) {
    keys +=
        (keys.empty() ? "legacy: " : ", legacy: ") + std::string(right.legacy ? "true" : "false");
  }
  return "the markers are not where a board of " + std::to_string(settings.squares_x) +
         " squares in a row has them; write " + keys;
}

}  // namespace kinecal::detail
