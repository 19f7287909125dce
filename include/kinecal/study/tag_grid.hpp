// A picture of a grid of AprilTags, for a board in a scene: one pixel per bit.
//
// The tag of id 0 is at the bottom left; ids go to the right, then up, as on Kalibr's boards.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kinecal/capture/image.hpp"

namespace kinecal {

/// The tags of a grid, in bits of their code.
struct TagGridShape {
  int border = 1;            ///< width of a tag's black border
  int gap = 2;               ///< between tags
  int margin = 2;            ///< around the grid
  bool has_squares = false;  ///< black ones between the corners of tags, which touch them

  /// Width of a tag of the family tag36h11.
  [[nodiscard]] constexpr int tag() const { return 6 + 2 * border; }
  /// Width of the picture of so many tags.
  [[nodiscard]] constexpr int width(int tags) const {
    return tags * (tag() + gap) - gap + 2 * margin;
  }
};

inline constexpr TagGridShape kPlainTags = {};                ///< gaps of a quarter of a tag
inline constexpr TagGridShape kKalibrTags = {2, 3, 6, true};  ///< as Kalibr makes them

/// Draws tags of the family tag36h11.
/// @throws std::invalid_argument  if the grid has no tag, or more than the family has
/// @throws std::runtime_error     if kinecal was built without libapriltag
[[nodiscard]] GrayImage tag_grid_picture(int columns, int rows,
                                         const TagGridShape& shape = kPlainTags);

}  // namespace kinecal
