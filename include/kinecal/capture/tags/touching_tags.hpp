// Tags whose corners touch black squares, as in the AprilGrids that Kalibr makes.
//
// libapriltag's outlines of tags run together with the squares.  So the first tags are found in an
// image in which black has shrunk; each corner is the saddle between tag and square; each tag
// predicts the corners of its neighbours, whose codes are then read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "kinecal/capture/image.hpp"
#include "kinecal/capture/tags/april_tags.hpp"

namespace kinecal::detail {

/// A grid of tags to search for.
struct TouchingGrid {
  double spacing = 0.3;       ///< gap between tags, as a fraction of their size: the squares' size
  int wrong_bits = 1;         ///< tolerated in a code
  std::vector<int> ids = {};  ///< of its tags, ascending

  [[nodiscard]] bool has(int id) const { return std::binary_search(ids.begin(), ids.end(), id); }
};

/// All tags of an image: those given, or, if black squares touch them, the tags between squares.
/// @param found  what reader.read() found
[[nodiscard]] std::vector<SeenTag> with_touching_tags(const TagReader& reader,
                                                      const GrayImage& image,
                                                      const TouchingGrid& grid,
                                                      std::vector<SeenTag> found);

}  // namespace kinecal::detail
