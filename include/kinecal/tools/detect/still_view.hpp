// Chooses one of several views of a standstill.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/capture/view.hpp"

namespace kinecal {

/// The chosen view, or why it is missing.
struct StillView {
  std::size_t index = 0;     ///< of the view
  std::string refusal = {};  ///< empty if one was chosen
};

/// Chooses from the longest run of unchanged images: the middle one, or one that is clearly
/// sharper.  A single image cannot be compared and is used as it is; so are views without images.
/// @param views  at least one, in the order of their stamps
[[nodiscard]] StillView still_view(std::span<const View> views);

/// Mean square of the differences between neighbouring pixels, grey levels squared.
[[nodiscard]] double sharpness(const GrayImage& image);

}  // namespace kinecal
