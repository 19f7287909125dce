// An image in which black areas are smaller, so that those which touch at corners are apart.
//
// White grows by a pixel up, down, left and right, so edges move by a pixel, or by 0.7 pixels if they are
// diagonal.  Growing diagonally, too, would move those by 1.4 pixels, and fill the cells of small tags.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// Sizes at which to search an image, of its own: first with at most 1.5 megapixels, then larger ones,
/// which take longer and show smaller tags, up to 1.5 or 8 megapixels.
[[nodiscard]] std::vector<double> search_scales(const GrayImage& image);

/// An image at another size, in which white has grown by a pixel.
/// @param scale  of the new size to the old, positive
[[nodiscard]] GrayImage shrunk_black(const GrayImage& image, double scale);

/// Where a place of an image at another size is in the original one, pixels.
[[nodiscard]] inline Eigen::Vector2d at_full_size(const Eigen::Vector2d& pixel, double scale) {
  return (pixel + Eigen::Vector2d::Constant(0.5)) / scale - Eigen::Vector2d::Constant(0.5);
}

}  // namespace kinecal::detail
