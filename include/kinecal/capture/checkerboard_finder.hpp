// Finds a checkerboard in an image: a Finder, as robot_calibration's CheckerboardFinder and
// CheckerboardFinder2d.
//
//   const CheckerboardFinder finder({.points_x = 5, .points_y = 4, .size = 0.0245});
//   const Found found = finder.find(view);
//
// Corner (column, row) is at (column * size, row * size, 0) of the board and has the id
// row * points_x + column; board_order.hpp says which corner is the first.  A board that looks the same
// when it is turned needs resolve_flips() (board_flips.hpp) after the session.  Several boards in one
// image, each of its own size, are several finders.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/robot_interface.hpp"
#include "kinecal/capture/target.hpp"

namespace kinecal {

/// A checkerboard, in the words of robot_calibration.
struct CheckerboardSettings {
  int points_x = 5;            ///< inner corners of a row; at least 3
  int points_y = 4;            ///< inner corners of a column; at least 3
  double size = 0.0245;        ///< side of a square, metres
  TargetSettings target = {};  ///< its sensors and what is demanded of its image
};

/// Finds one checkerboard, whole, with its corners between the pixels.  It needs OpenCV.
class CheckerboardFinder {
 public:
  /// @throws std::invalid_argument  if the board has fewer than 3 x 3 corners, its size is not
  ///                                positive, or check_target() refuses
  explicit CheckerboardFinder(CheckerboardSettings settings);

  /// The board in a view, or why it was not found: it is not there, it is there twice, it is part of
  /// a larger one, too small, blurred, over-exposed, behind glare, at the border.
  [[nodiscard]] Found find(const View& view) const;

  /// As it was constructed.
  [[nodiscard]] const CheckerboardSettings& settings() const { return settings_; }

 private:
  [[nodiscard]] std::string quality_fault(const GrayImage& image,
                                          const std::vector<Eigen::Vector2d>& corners) const;

  CheckerboardSettings settings_;
};
static_assert(Finder<CheckerboardFinder>);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/checkerboard_finder.ipp"
#endif
