// Names of the ninths of an image: "upper left".
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

namespace kinecal {

/// Number of regions.
inline constexpr std::size_t kImageRegions = 9;

/// Their names, row by row.
inline constexpr std::array<const char*, kImageRegions> kImageRegionNames = {
    "upper left", "top",        "upper right", "left",       "middle",
    "right",      "lower left", "bottom",      "lower right"};

/// The region of a place.
/// @param x, y  shares of the width and height, from the upper left corner
[[nodiscard]] inline std::size_t image_region(double x, double y) {
  const auto third = [](double share) {
    return static_cast<std::size_t>(std::clamp(3.0 * share, 0.0, 2.9));
  };
  return 3 * third(y) + third(x);
}

/// "the upper left, the top and 2 more regions" of the regions that are marked; empty if none is.
[[nodiscard]] inline std::string image_regions_text(const std::array<bool, kImageRegions>& marked) {
  constexpr std::ptrdiff_t kListed = 4;
  const std::ptrdiff_t all = std::count(marked.begin(), marked.end(), true);
  const std::ptrdiff_t listed = all <= kListed ? all : kListed - 1;
  std::string text;
  std::ptrdiff_t count = 0;
  for (std::size_t i = 0; i < kImageRegions; ++i) {
    if (!marked[i] || ++count > listed) continue;
    text += (count == 1     ? "the "
             : count == all ? " and the "
                            : ", the ") +
            std::string(kImageRegionNames[i]);
  }
  if (listed < all) text += " and " + std::to_string(all - listed) + " more regions";
  return text;
}

}  // namespace kinecal
