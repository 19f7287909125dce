// AprilTags as libapriltag draws them, in a grid.
#pragma once

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "support/board_images.hpp"

namespace kinecal::test {

inline constexpr double kTagSize = 0.05;    // metres
inline constexpr double kTagSpacing = 0.3;  // of the size

/// A tag as libapriltag draws it, with a border of so many bits: brightness of cells from the top
/// left, its white margin left out.
inline GrayImage drawn_tag(int id, int border) {
  apriltag_family_t* family = tag36h11_create();
  image_u8_t* drawn = apriltag_to_image(family, id);
  const int width = family->width_at_border, margin = (drawn->width - width) / 2;
  GrayImage cells(width + 2 * border - 2, width + 2 * border - 2, 0);
  for (int v = 0; v < width; ++v) {
    for (int u = 0; u < width; ++u) {
      cells(u + border - 1, v + border - 1) = drawn->buf[(v + margin) * drawn->stride + u + margin];
    }
  }
  std::free(drawn->buf);
  std::free(drawn);
  tag36h11_destroy(family);
  return cells;
}

/// A grid of tags, ids from the bottom left; `twice` puts tag 0 in the last place, too.
inline Print tag_grid(int columns, int rows, int border = 1, bool twice = false) {
  std::vector<GrayImage> tags;
  for (int i = 0; i < columns * rows; ++i) {
    tags.push_back(drawn_tag(twice && i + 1 == columns * rows ? 0 : i, border));
  }
  return [=](double x, double y) {
    const double pitch = kTagSize * (1 + kTagSpacing), gap = kTagSize * kTagSpacing;
    const double right = columns * pitch, top = rows * pitch;
    if (x < -gap || y < -gap || x > right || y > top) return -1.0;
    const int column = static_cast<int>(std::floor(x / pitch)),
              row = static_cast<int>(std::floor(y / pitch));
    if (column < 0 || row < 0 || column >= columns || row >= rows) return 1.0;
    const double a = (x - column * pitch) / kTagSize, b = (y - row * pitch) / kTagSize;
    if (a < 0 || b < 0 || a >= 1 || b >= 1) return 1.0;
    const GrayImage& cells = tags[static_cast<std::size_t>(row * columns + column)];
    const int u = static_cast<int>(a * cells.width), v = static_cast<int>((1 - b) * cells.height);
    return cells(u, std::min(v, cells.height - 1)) > 127 ? 1.0 : 0.0;
  };
}

/// The grid as Kalibr makes it: a black square at each corner of a tag, which touches it.
inline Print kalibr_grid(int columns, int rows, int border = 2) {
  const Print tags = tag_grid(columns, rows, border);
  return [=](double x, double y) {
    const double pitch = kTagSize * (1 + kTagSpacing), gap = kTagSize * kTagSpacing;
    const double right = columns * pitch, top = rows * pitch;
    if (x < -2 * gap || y < -2 * gap || x > right + gap || y > top + gap) return -1.0;
    if (x < -gap || y < -gap || x >= right || y >= top) return 1.0;
    const double a = x - std::floor(x / pitch) * pitch, b = y - std::floor(y / pitch) * pitch;
    return a > kTagSize && b > kTagSize ? 0.0 : tags(x, y);
  };
}

}  // namespace kinecal::test
