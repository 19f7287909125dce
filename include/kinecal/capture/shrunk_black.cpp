// Definitions of shrunk_black.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/shrunk_black.hpp"

#include <algorithm>

namespace kinecal::detail {

int reduction(const GrayImage& image) {
  constexpr double kMost = 1.5e6;
  const double pixels = static_cast<double>(image.width) * image.height;
  int factor = 1;
  while (pixels > kMost * factor * factor) ++factor;
  return factor;
}

namespace {

[[nodiscard]] GrayImage block_means(const GrayImage& image, int factor) {
  if (factor == 1) return image;
  GrayImage small(image.width / factor, image.height / factor);
  const int count = factor * factor;
  for (int v = 0; v < small.height; ++v) {
    for (int u = 0; u < small.width; ++u) {
      int sum = count / 2;
      for (int j = 0; j < factor; ++j) {
        for (int i = 0; i < factor; ++i) sum += image(u * factor + i, v * factor + j);
      }
      small(u, v) = static_cast<std::uint8_t>(sum / count);
    }
  }
  return small;
}

}  // namespace

GrayImage shrunk_black(const GrayImage& image, int factor, int pixels) {
  GrayImage now = block_means(image, factor);
  for (int pass = 0; pass < pixels; ++pass) {
    GrayImage rows = now;
    for (int v = 0; v < now.height; ++v) {
      for (int u = 1; u + 1 < now.width; ++u) {
        rows(u, v) = std::max({now(u - 1, v), now(u, v), now(u + 1, v)});
      }
    }
    now = rows;
    for (int v = 1; v + 1 < now.height; ++v) {
      for (int u = 0; u < now.width; ++u) {
        now(u, v) = std::max({rows(u, v - 1), rows(u, v), rows(u, v + 1)});
      }
    }
  }
  return now;
}

}  // namespace kinecal::detail
