// Initial values of an uncalibrated camera from views of a flat target: focal length, pinhole or fisheye, and the
// target's pose in each view.
//
// A grid of focal lengths is tried, each as a pinhole and as a fisheye.  With the principal point in the middle of the
// image, a focal length turns pixels into directions, and a homography gives the target's pose.  The guess with the
// smallest median reprojection error is refined.  Nothing has to be guessed by the user, and no single view decides.
// Source: Zhang, A Flexible New Technique for Camera Calibration, 2000 (poses from homographies).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "kinecal/config/cameras/lens_start.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// A view of a flat target: its corners, in the same order.
struct TargetView {
  std::vector<Eigen::Vector2d> plane;   ///< (2) each, metres, on the target
  std::vector<Eigen::Vector2d> pixels;  ///< (2) each
};

/// What a pixel (2) shows: (3) of any length in the optical frame; not a number where the lens sees nothing.
using PixelDirection = std::function<Vector3<double>(const Eigen::Vector2d& pixel)>;

/// camera_T_target of a view, fitted; nullopt if its corners do not determine it.
[[nodiscard]] std::optional<Pose<double>> pose_of_view(const TargetView& view,
                                                       const PixelDirection& direction);

/// Some views, those with the most corners first.
/// @param most  how many of them
[[nodiscard]] std::vector<TargetView> telling_views(std::span<const TargetView> views,
                                                    std::size_t most);

/// The angle from the axis at which the farthest corner is seen, degrees.
[[nodiscard]] double farthest_degrees(std::span<const TargetView> views,
                                      const PixelDirection& direction);

/// A camera of which little is known.
struct CameraStart {
  RoundLens lens;             ///< rough
  Eigen::Vector2d center;     ///< (2) principal point, pixels
  double most_degrees = 0.0;  ///< angle of the farthest corner from the axis
  double typical = 0.0;       ///< median distance of corners, pixels

  /// The direction of a pixel.
  /// @returns  (3) unit vector in the optical frame; not a number outside of the image of the lens
  [[nodiscard]] Vector3<double> direction(const Eigen::Vector2d& pixel) const;
  /// The pixel of a point (3).
  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& point) const;
  /// camera_T_target of a view by a homography; nullopt if its corners do not determine it.
  [[nodiscard]] std::optional<Pose<double>> pose(const TargetView& view) const;
};

/// Finds a camera by its views.
/// @param width, height  of the image, pixels
/// @returns  nullopt if no view has four corners that are not on a line
[[nodiscard]] std::optional<CameraStart> camera_start(std::span<const TargetView> views,
                                                      double width, double height);

}  // namespace kinecal
