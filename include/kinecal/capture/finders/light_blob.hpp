// A connected light in an image: centroid, size and shape.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/finders/image_motion.hpp"
#include "kinecal/capture/image.hpp"

namespace kinecal {

/// A pixel.
struct LightPixel {
  int u = 0, v = 0;  ///< column and row
};

/// A connected light.  Each pixel is weighted by its brightness above that of the edge.
struct LightBlob {
  double u = 0.0, v = 0.0;              ///< centroid, pixels
  double uu = 0.0, uv = 0.0, vv = 0.0;  ///< covariance of its pixels, pixels^2
  int pixels = 0;                       ///< their number
  PixelBox box;                         ///< around them

  /// Ratio of the longest to the shortest extent; 1 for a disc.
  [[nodiscard]] double elongation() const;
};

/// The pixels connected to the brightest one with more than 0.3 of its brightness.
/// @param peak  in the image, brighter than 0
[[nodiscard]] LightBlob light_blob(const Image<float>& light, const LightPixel& peak);

}  // namespace kinecal
