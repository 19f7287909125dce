// Of several views of one standstill, the one to be used.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "kinecal/capture/view.hpp"
#include "kinecal/linkage.hpp"

namespace kinecal {

/// The view that was chosen, or why none was.
struct StillView {
  std::size_t index = 0;     ///< of the view
  std::string refusal = {};  ///< empty if one was chosen
};

/// Chooses from the longest run of images that do not change: the middle one, or one that is clearly
/// sharper.  A single image cannot be compared and is taken as it is; so are views without images.
/// @param views  at least one, in the order of their stamps
[[nodiscard]] StillView still_view(std::span<const View> views);

/// Mean square of the differences between neighbours, grey levels squared.
[[nodiscard]] double sharpness(const GrayImage& image);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/tools/detect/still_view.ipp"
#endif
