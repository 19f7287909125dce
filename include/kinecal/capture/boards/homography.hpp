// The homography between a plane and its image, and the pose of a plane that a camera sees.
//
//   s (u, v, 1) = H (x, y, 1)
// Source: Hartley and Zisserman, Multiple View Geometry, 4.1 (normalized direct linear transform);
// Zhang, A Flexible New Technique for Camera Calibration, 2000 (pose from H).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// H that maps points of a plane to points of another, by least squares.
/// @param from, to  (2) each, at least four, in the same order
/// @param weights   of the points, not negative; empty: all the same
/// @returns         (3 x 3); nullopt if they are too few, or on one line
[[nodiscard]] std::optional<Matrix3<double>> homography(const std::vector<Eigen::Vector2d>& from,
                                                        const std::vector<Eigen::Vector2d>& to,
                                                        const std::vector<double>& weights = {});

/// The image of a point under H (2).
[[nodiscard]] Eigen::Vector2d mapped(const Matrix3<double>& h, const Eigen::Vector2d& point);

/// camera_T_plane from the images of points of the plane z = 0.
/// @param plane  (2) each, metres
/// @param rays   (2) each: x / z and y / z in the camera's optical frame
/// @returns      nullopt if the points do not determine it
[[nodiscard]] std::optional<Pose<double>> plane_pose(const std::vector<Eigen::Vector2d>& plane,
                                                     const std::vector<Eigen::Vector2d>& rays);

/// The same from directions in the optical frame, also of a lens that sees all around.
/// @param directions  (3) each, of any length, within a half space around their mean
[[nodiscard]] std::optional<Pose<double>> plane_pose(
    const std::vector<Eigen::Vector2d>& plane, const std::vector<Vector3<double>>& directions);

/// (3 x 3) R that turns directions so that their mean is the optical axis.
/// @param directions  (3) each, of any length
[[nodiscard]] Matrix3<double> turn_to_axis(const std::vector<Vector3<double>>& directions);

/// a_T_b that maps points of b onto those of a, by least squares.
/// @param in_a, in_b  (3) each, metres; at least three, in the same order
/// @returns           nullopt if they are on one line
/// Source: Umeyama, Least-Squares Estimation of Transformation Parameters, 1991
[[nodiscard]] std::optional<Pose<double>> rigid_fit(const std::vector<Vector3<double>>& in_a,
                                                    const std::vector<Vector3<double>>& in_b);

}  // namespace kinecal
