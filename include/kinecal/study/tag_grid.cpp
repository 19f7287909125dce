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
GrayImage tag_grid_picture(int columns, int rows) {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(),
                                                                                tag36h11_destroy);
  if (columns < 1 || rows < 1 || columns > static_cast<int>(family->ncodes) / rows) {
    throw std::invalid_argument("a grid of " + std::to_string(columns) + " x " +
                                std::to_string(rows) + " tags; there are " +
                                std::to_string(family->ncodes) + " tags");
  }
  constexpr int kStep = kTagBits + kTagGap;
  constexpr std::uint8_t kWhite = 230, kBlack = 20;
  GrayImage picture(columns * kStep + kTagGap, rows * kStep + kTagGap, kWhite);
  const auto bits = static_cast<int>(family->nbits);
  for (int id = 0; id < columns * rows; ++id) {
    const int left = kTagGap + kStep * (id % columns);
    const int top = kTagGap + kStep * (rows - 1 - id / columns);
    for (int v = 0; v < kTagBits; ++v) {
      for (int u = 0; u < kTagBits; ++u) picture(left + u, top + v) = kBlack;
    }
    for (int i = 0; i < bits; ++i) {
      if (((family->codes[id] >> (bits - 1 - i)) & 1U) == 0) continue;
      picture(left + static_cast<int>(family->bit_x[i]), top + static_cast<int>(family->bit_y[i])) =
          kWhite;
    }
  }
  return picture;
}
#else
GrayImage tag_grid_picture(int, int) {
  throw std::runtime_error(
      "AprilTags cannot be drawn: kinecal was built without libapriltag (libapriltag-dev)");
}
#endif

}  // namespace kinecal
