// An image in which black areas are smaller, so that those which touch at corners are apart.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"

namespace kinecal::detail {

/// By which factor a large image is to be reduced for a search: to at most 1.5 megapixels.
[[nodiscard]] int reduction(const GrayImage& image);

/// An image reduced by a factor, each pixel the mean of a block, in which white then grows by so many
/// pixels: each gets the highest brightness around it.
[[nodiscard]] GrayImage shrunk_black(const GrayImage& image, int factor, int pixels);

}  // namespace kinecal::detail
