// Corners of a flat target as a camera with some lens sees them, without an image.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "kinecal/capture/boards/target.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal::test {

/// A view of corners.
struct BoardView {
  int width = 1280, height = 960;
  double focal = 600.0;
  bool fisheye = false;  ///< r = f theta
  double noise = 0.1;    ///< of each coordinate, pixels
  Pose<double> camera_T_board{exp(Vector3<double>(2.8, 0.3, 0.2)), {-0.1, 0.1, 0.45}};

  [[nodiscard]] CameraInfo camera() const {
    CameraInfo info;
    info.width = width;
    info.height = height;
    info.distortion_model = "plumb_bob";
    info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
    info.k = {focal, 0, 0.5 * width, 0, focal, 0.5 * height, 0, 0, 1};
    info.p = {focal, 0, 0.5 * width, 0, 0, focal, 0.5 * height, 0, 0, 0, 1, 0};
    return info;
  }

  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& on_board) const {
    const Vector3<double> p = camera_T_board * on_board;
    const double r = p.head<2>().norm();
    const double scale = fisheye && r > 0.0 ? std::atan2(r, p.z()) / r : 1.0 / p.z();
    return Eigen::Vector2d(0.5 * width, 0.5 * height) + focal * scale * p.head<2>();
  }

  /// Sets the pixels of corners.
  [[nodiscard]] std::vector<TargetCorner> see(std::vector<TargetCorner> corners,
                                              unsigned seed = 1) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> error(0.0, noise);
    for (TargetCorner& corner : corners) {
      corner.pixel = pixel(corner.target);
      corner.pixel += Eigen::Vector2d(error(random), error(random));
    }
    return corners;
  }
};

/// Corners of a checkerboard.
inline std::vector<TargetCorner> board_corners(int columns, int rows, double size) {
  std::vector<TargetCorner> corners;
  for (int i = 0; i < columns * rows; ++i) {
    TargetCorner corner;
    corner.id = i;
    corner.target = {(i % columns) * size, (i / columns) * size, 0.0};
    corners.push_back(corner);
  }
  return corners;
}

}  // namespace kinecal::test
