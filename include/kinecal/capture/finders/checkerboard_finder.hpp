// A Finder for checkerboards, like robot_calibration's CheckerboardFinder and CheckerboardFinder2d.
//
//   const CheckerboardFinder finder({.points_x = 5, .points_y = 4, .size = 0.0245});
//   const Found found = finder.find(view);
//
// Corner (column, row) is at (column * size, row * size, 0) of the board and has the id
// row * points_x + column; board_order.hpp defines which corner is the first.  A board that looks
// the same when rotated needs resolve_flips() (board_flips.hpp) after the session.  For several
// boards in one image, each of its own size, use several finders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/capture/robot_interface.hpp"

namespace kinecal {

class CheckerboardFinder;

/// A checkerboard, with robot_calibration's names.
struct CheckerboardSettings {
  using FinderType = CheckerboardFinder;  ///< finds it

  int points_x = 5;            ///< inner corners of a row; at least 3
  int points_y = 4;            ///< inner corners of a column; at least 3
  double size = 0.0245;        ///< side of a square, metres
  TargetSettings target = {};  ///< its sensors, and requirements on its image
};

/// Finds one complete checkerboard, with sub-pixel corners.  Needs OpenCV.
class CheckerboardFinder {
 public:
  /// @throws std::invalid_argument  if the board has fewer than 3 x 3 corners, its size is not
  ///                                positive, or check_target() throws
  explicit CheckerboardFinder(CheckerboardSettings settings);

  /// The board in a view, or why it is missing: not visible, visible twice, part of a larger board,
  /// too small, blurred, over-exposed, behind glare, at the border.
  [[nodiscard]] Found find(const View& view) const;

  /// The settings.
  [[nodiscard]] const CheckerboardSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] std::string quality_fault(const GrayImage& image,
                                          const std::vector<Eigen::Vector2d>& corners) const;

  CheckerboardSettings settings_;
};
static_assert(Finder<CheckerboardFinder>);

}  // namespace kinecal
