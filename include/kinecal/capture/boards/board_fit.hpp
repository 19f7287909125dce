// Tests whether the corners of a flat target agree with one view of it.
//
//   pixel = lens(H (x, y, 1))
//
// H is a homography.  The lens is a pinhole, that of camera_info, r_u = r / (1 + k r^2) about the image
// centre, or an equidistant fisheye, whatever agrees best; if more is left, a smooth field (a polynomial of x and y) is added.
// So a lens that nobody has calibrated costs no right corner.  Weights that fall to zero for distant
// corners make H follow the majority.
// Source: Fitzgibbon, Simultaneous linear estimation of multiple view geometry and lens distortion,
// 2001 (division model); Geman, McClure, Statistical methods for tomographic image reconstruction,
// 1987 (weights).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/boards/target.hpp"

namespace kinecal {

/// How the corners of a view agree with each other.
struct BoardFit {
  std::vector<double> off;  ///< distance of each corner from where the others put it, pixels
  std::vector<Eigen::Vector2d> fitted;  ///< that place, of each corner
  double typical = 0.0;                 ///< median of these
  double limit = 0.0;                   ///< a corner that is farther off is wrong
  double gap = 0.0;                     ///< median distance of neighbouring corners, pixels

  /// True if most corners agree.
  [[nodiscard]] bool agrees() const;
  /// Number of corners that are farther off than the limit.
  [[nodiscard]] int wrong() const;
};

/// Fits a view of a flat target.  Without `off`, the corners cannot show whether they are right:
/// they are fewer than 8, or not in one plane.
/// @param camera  of the view
[[nodiscard]] BoardFit fit_board(const std::vector<TargetCorner>& corners,
                                 const CameraInfo& camera);

/// Why a view cannot be used: its corners do not agree, or too many are wrong.  Empty if it can.
[[nodiscard]] std::string board_fault(const BoardFit& fit);

/// Drops corners that are farther off than the limit.
/// @param found  those that were fitted; those that are left
void drop_wrong_corners(const BoardFit& fit, std::vector<TargetCorner>& found);

/// Fits the corners of a view, and drops those that are far from where the others put them.
/// @param found  the corners of a view; those that are left
/// @returns      why the view cannot be used; empty if it can
[[nodiscard]] std::string drop_wrong_corners(const CameraInfo& camera,
                                             std::vector<TargetCorner>& found);

/// The note of a view that lost corners.
inline constexpr const char* kWrongCornersNote =
    "corners that are not where the others of their view put them are left out";

}  // namespace kinecal
