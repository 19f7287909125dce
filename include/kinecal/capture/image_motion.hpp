// Where images change although nothing was switched: what moves.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// A rectangle of pixels, its last ones included.
struct PixelBox {
  int left = 0, top = 0, right = -1, bottom = -1;  ///< columns and rows

  /// True if a pixel (column, row) is in it.
  [[nodiscard]] bool contains(int u, int v) const {
    return u >= left && u <= right && v >= top && v <= bottom;
  }
  /// The same, larger by some pixels on each side.
  [[nodiscard]] PixelBox grown(int by) const {
    return {left - by, top - by, right + by, bottom + by};
  }
};

/// Pixels that changed between images of the same scene: by more than the sensor's noise, which is
/// estimated from the images, and than the light of the whole image.
class ImageMotion {
 public:
  /// Compares two images.
  /// @throws std::invalid_argument  if their sizes differ, or differ from those before
  void add(const GrayImage& earlier, const GrayImage& later);

  /// Share of pixels that ever changed in a box, but for those in a part of it; 0 of no pixel.
  [[nodiscard]] double share(const PixelBox& box, const PixelBox& except = {}) const;

 private:
  GrayImage changed_;  // 1 where a pixel changed
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/capture/image_motion.ipp"
#endif
