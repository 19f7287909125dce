// The images of the centres of discs on a plane.
//
// A disc appears as an ellipse, whose middle is not the image of the disc's centre but farther from the
// viewer's side.  With H from the plane to the image, the circle C about the centre c appears as the conic
//
//   Q = H^-T C H^-1      middle: -Q_xx^-1 Q_x      offset = middle - H(c)
//
// Middles are measured as centroids of darkness.  The offset is taken off, H fitted again, and so on.
// Source: Heikkila, Geometric Camera Calibration Using Circular Control Points, 2000.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/geometry/rotation.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The middle of the ellipse as which a circle appears (2).
/// @param h       (3 x 3) maps the circle's plane to the image
/// @param centre  (2) of the circle, in its plane
/// @param radius  in the unit of the plane
[[nodiscard]] Eigen::Vector2d ellipse_middle(const Matrix3<double>& h,
                                             const Eigen::Vector2d& centre, double radius);

/// Discs in an image.
struct DiscCentres {
  std::vector<Eigen::Vector2d> pixels;  ///< (2) images of the centres
  double radius = 0.0;                  ///< median, in the unit of the plane
  Matrix3<double> h =
      Matrix3<double>::Identity();  ///< (3 x 3) from the plane to the image, without a lens
};

/// The centres of black discs on white, to a fraction of a pixel.
/// @param plane   (2) of each, in the plane
/// @param about   (2) pixels, where each is about
/// @param gap     least distance of two centres, in the plane
/// @param camera  whose lens bends the image; one that is not known is taken as none
/// @returns       nullopt if they are not to be seen there
[[nodiscard]] std::optional<DiscCentres> disc_centres(const GrayImage& image,
                                                      const std::vector<Eigen::Vector2d>& plane,
                                                      const std::vector<Eigen::Vector2d>& about,
                                                      double gap, const CameraInfo& camera);

}  // namespace kinecal
