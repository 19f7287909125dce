// A Finder for grids of black discs on white, or white ones on black, symmetric or asymmetric, as OpenCV draws them.
//
//   const CircleGridFinder finder({.points_x = 4, .points_y = 11, .size = 0.02, .asymmetric = true});
//
// The disc (column, row) has the id row * points_x + column, x goes right, y down, z away from the viewer:
//   symmetric   (column size, row size, 0)
//   asymmetric  ((2 column + row mod 2) size, row size, 0)
// An asymmetric grid with an odd number of rows looks different from every side.  Others look the same when
// rotated by half a turn (symmetric ones of as many columns as rows: a quarter): x is then what points most
// to the image's right, and they need resolve_flips() (board_flips.hpp) after the session.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

class CircleGridFinder;

/// A grid of discs.
struct CircleGridSettings {
  using FinderType = CircleGridFinder;  ///< finds it

  int points_x = 4;    ///< discs of a row; at least 2
  int points_y = 11;   ///< rows; at least 2
  double size = 0.02;  ///< distance of rows, metres; of columns, too, or half of it if asymmetric
  bool asymmetric = true;  ///< every other row is shifted by `size`, its discs are 2 `size` apart
  TargetSettings target = {};  ///< its sensors, and requirements on its image
};

/// The smallest number of quarter turns after which a grid looks the same: 1, 2, or 4.
[[nodiscard]] int turns_alike(const CircleGridSettings& grid);

/// Finds one complete grid of discs, with their centres corrected for perspective.  Needs OpenCV.
class CircleGridFinder {
 public:
  /// @throws std::invalid_argument  if the grid has fewer than 2 x 2 discs, its size is not positive, its
  ///                                pose is wanted but it looks alike, or check_target() throws
  explicit CircleGridFinder(CircleGridSettings settings);

  /// The grid in a view, or why it is missing: not visible, too small, blurred.
  [[nodiscard]] Found find(const View& view) const;

  /// The settings.
  [[nodiscard]] const CircleGridSettings& settings() const { return settings_; }

 private:
  CircleGridSettings settings_;
};
static_assert(Finder<CircleGridFinder>);

}  // namespace kinecal
