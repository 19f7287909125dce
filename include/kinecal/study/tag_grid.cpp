// Definitions of tag_grid.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/tag_grid.hpp"

#ifdef KINECAL_HAVE_APRILTAG
#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>
#endif

#include <memory>
#include <stdexcept>
#include <string>

namespace kinecal {

#ifdef KINECAL_HAVE_APRILTAG
namespace detail {
namespace {

void paint_square(GrayImage& picture, int left, int top, int side, std::uint8_t grey) {
  for (int v = top; v < top + side; ++v) {
    for (int u = left; u < left + side; ++u) picture(u, v) = grey;
  }
}

}  // namespace
}  // namespace detail

GrayImage tag_grid_picture(int columns, int rows, const TagGridShape& shape) {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  if (columns < 1 || rows < 1 || columns > static_cast<int>(family->ncodes) / rows) {
    throw std::invalid_argument("a grid of " + std::to_string(columns) + " x " +
                                std::to_string(rows) + " tags; there are " +
                                std::to_string(family->ncodes) + " tags");
  }
  const int step = shape.tag() + shape.gap, more = shape.border - 1;
  constexpr std::uint8_t kWhite = 230, kBlack = 20;
  GrayImage picture(shape.width(columns), shape.width(rows), kWhite);
  for (int i = 0; shape.has_squares && i < (columns + 1) * (rows + 1); ++i) {
    detail::paint_square(picture, shape.margin - shape.gap + step * (i % (columns + 1)),
                         shape.margin - shape.gap + step * (i / (columns + 1)), shape.gap, kBlack);
  }
  const auto bits = static_cast<int>(family->nbits);
  for (int id = 0; id < columns * rows; ++id) {
    const int left = shape.margin + step * (id % columns);
    const int top = shape.margin + step * (rows - 1 - id / columns);
    detail::paint_square(picture, left, top, shape.tag(), kBlack);
    for (int i = 0; i < bits; ++i) {
      if (((family->codes[id] >> (bits - 1 - i)) & 1U) == 0) continue;
      picture(left + more + static_cast<int>(family->bit_x[i]),
              top + more + static_cast<int>(family->bit_y[i])) = kWhite;
    }
  }
  return picture;
}
#else
GrayImage tag_grid_picture(int, int, const TagGridShape&) {
  throw std::runtime_error(
      "AprilTags cannot be drawn: kinecal was built without libapriltag (libapriltag-dev)");
}
#endif

}  // namespace kinecal
