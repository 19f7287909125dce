// Finds motion: where images change although nothing was switched.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// A rectangle of pixels, including its last ones.
struct PixelBox {
  int left = 0, top = 0, right = -1, bottom = -1;  ///< columns and rows

  /// True if a pixel (column, row) is in it.
  [[nodiscard]] bool contains(int u, int v) const {
    return u >= left && u <= right && v >= top && v <= bottom;
  }
  /// The box enlarged by some pixels on each side.
  [[nodiscard]] PixelBox grown(int by) const {
    return {left - by, top - by, right + by, bottom + by};
  }
};

/// Pixels that changed between images of the same scene by more than the sensor's noise, estimated
/// from the images, and more than the light of the whole image.
class ImageMotion {
 public:
  /// Compares two images.
  /// @throws std::invalid_argument  if their sizes differ, or differ from those before
  void add(const GrayImage& earlier, const GrayImage& later);

  /// Fraction of pixels in a box, outside an inner part, that ever changed; 0 if absent.
  [[nodiscard]] double share(const PixelBox& box, const PixelBox& except = {}) const;

 private:
  GrayImage changed_;  // 1 where a pixel changed
};

}  // namespace kinecal
