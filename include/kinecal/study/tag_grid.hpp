// A picture of a grid of AprilTags, for a board in a scene: one pixel per bit.
//
// The tag of id 0 is at the bottom left; ids go to the right, then up, as on Kalibr's boards.  A
// tag's black border is 8 bits wide; gaps and the margin are 2 bits (a quarter of a tag).
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"

namespace kinecal {

inline constexpr int kTagBits = 8;  ///< width of a tag in its picture
inline constexpr int kTagGap = 2;   ///< width of gaps and of the margin in the picture

/// Draws tags of the family tag36h11.
/// @throws std::invalid_argument  if the grid has no tag, or more than the family has
/// @throws std::runtime_error     if kinecal was built without libapriltag
[[nodiscard]] GrayImage tag_grid_picture(int columns, int rows);

}  // namespace kinecal
