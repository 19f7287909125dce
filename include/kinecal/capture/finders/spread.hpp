// Picks a few of many points, evenly.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "kinecal/geometry/rotation.hpp"

namespace kinecal {

/// At most `count` of the indices 0 to size - 1, ascending: one from each of `count` equal pieces,
/// at offsets that follow the golden ratio, so that they do not line up with rows of an image.
[[nodiscard]] std::vector<std::size_t> thinned(std::size_t size, std::size_t count);

/// At most `count` of the points, evenly spread in space: each is the farthest from all before it.
/// Source: Eldar et al., The farthest point strategy for progressive image sampling, 1997.
/// @param points  (3) metres, finite
/// @return        indices, ascending
[[nodiscard]] std::vector<std::size_t> spread(std::span<const Vector3<double>> points,
                                              std::size_t count);

}  // namespace kinecal
