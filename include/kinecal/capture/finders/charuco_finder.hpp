// A Finder for ChArUco boards: checkerboards with ArUco markers in the white squares.  A part of
// the board may be out of view.
//
// The frame of the board is at the outer corner of its top left square, x right, y down, z away
// from the viewer.  Inner corner (column, row) is at ((column + 1) square, (row + 1) square, 0) and
// has the id row * (squares_x - 1) + column.  A corner is found if both adjacent markers are.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

class CharucoFinder;

/// A ChArUco board, with OpenCV's names.
struct CharucoSettings {
  using FinderType = CharucoFinder;  ///< finds it

  int squares_x = 5;                       ///< squares of a row
  int squares_y = 7;                       ///< squares of a column
  double square_size = 0.04;               ///< side of a square, metres
  double marker_size = 0.03;               ///< side of a marker, metres
  std::string dictionary = "DICT_4X4_50";  ///< of the markers
  int first_id = 0;                        ///< of the first marker
  bool legacy = false;  ///< as drawn by OpenCV before 4.6: with an even number of rows, the top
                        ///< left square is white
  int min_corners = 6;  ///< required; in at least two rows and two columns
  TargetSettings target = {};  ///< its sensors, and requirements on its image
};

/// Finds one ChArUco board.  Needs OpenCV.
class CharucoFinder {
 public:
  /// @throws std::invalid_argument  if the board is impossible, its dictionary is unknown, or
  ///                                check_target() throws
  explicit CharucoFinder(CharucoSettings settings);

  /// The corners in a view, or why they are missing.
  [[nodiscard]] Found find(const View& view) const;

  /// The settings.
  [[nodiscard]] const CharucoSettings& settings() const { return settings_; }

 private:
  CharucoSettings settings_;
};
static_assert(Finder<CharucoFinder>);

}  // namespace kinecal
