// The images of the centres of discs on a plane.
//
// The image of a disc is an ellipse, bent by the lens, and its middle is not the image of the disc's centre.
// With f from the plane to the image, a homography and a lens that are fitted to the middles,
//
//   offset = middle of f(disc) - f(centre)
//
// Middles are measured as centroids of darkness.  The offset is taken off, f fitted again, and so on.
// Source: Heikkila, Geometric Camera Calibration Using Circular Control Points, 2000 (without a lens).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Maps a point of a plane (2) to the image (2), pixels.
using PlaneImage = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

/// The centroid of the image of a disc (2), pixels.
/// @param centre  (2) of the disc, in its plane
/// @param radius  in the unit of the plane
[[nodiscard]] Eigen::Vector2d middle_of_disc(const PlaneImage& image, const Eigen::Vector2d& centre,
                                             double radius);

/// Discs in an image.
struct DiscCentres {
  std::vector<Eigen::Vector2d> pixels;  ///< (2) images of the centres
  double radius = 0.0;                  ///< median, in the unit of the plane
  PlaneImage image;                     ///< of the plane
};

/// The centres of black discs on white, to a fraction of a pixel.
/// @param plane   (2) of each, in the plane
/// @param about   (2) pixels, where each is about
/// @param gap     least distance of two centres, in the plane
/// @param camera  of the image; a lens that it does not know is fitted
/// @returns       nullopt if they are not to be seen there
[[nodiscard]] std::optional<DiscCentres> disc_centres(const GrayImage& image,
                                                      const std::vector<Eigen::Vector2d>& plane,
                                                      const std::vector<Eigen::Vector2d>& about,
                                                      double gap, const CameraInfo& camera);

}  // namespace kinecal
