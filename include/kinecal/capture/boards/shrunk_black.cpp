// Definitions of shrunk_black.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/boards/shrunk_black.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/capture/boards/square_edges.hpp"

namespace kinecal::detail {

std::vector<double> search_scales(const GrayImage& image) {
  constexpr double kFirstPixels = 1.5e6, kMostPixels = 8e6, kStep = 1.5, kMost = 1.5;
  const double pixels = static_cast<double>(image.width) * image.height;
  std::vector<double> scales = {std::min(1.0, std::sqrt(kFirstPixels / pixels))};
  while (true) {
    const double next = scales.back() * kStep;
    if (next > kMost || next * next * pixels > kMostPixels) return scales;
    scales.push_back(next);
  }
}

namespace {

/// An image at another size: each pixel is a mean over its area.
[[nodiscard]] GrayImage resized(const GrayImage& image, double scale) {
  GrayImage sized(std::max(1, static_cast<int>(image.width * scale)),
                  std::max(1, static_cast<int>(image.height * scale)));
  const int side = std::max(1, static_cast<int>(std::ceil(1.0 / scale - 1e-9)));  // of samples
  for (int v = 0; v < sized.height; ++v) {
    for (int u = 0; u < sized.width; ++u) {
      double sum = 0.0;
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
          const Eigen::Vector2d off((i + 0.5) / side - 0.5, (j + 0.5) / side - 0.5);
          sum += brightness_at(image, at_full_size(Eigen::Vector2d(u, v) + off, scale));
        }
      }
      sized(u, v) = static_cast<std::uint8_t>(std::lround(sum / (side * side)));
    }
  }
  return sized;
}

}  // namespace

GrayImage shrunk_black(const GrayImage& image, double scale) {
  const GrayImage before = scale == 1.0 ? image : resized(image, scale);
  GrayImage now = before;
  for (int v = 1; v + 1 < now.height; ++v) {
    for (int u = 1; u + 1 < now.width; ++u) {
      now(u, v) = std::max(
          {before(u, v), before(u - 1, v), before(u + 1, v), before(u, v - 1), before(u, v + 1)});
    }
  }
  return now;
}

}  // namespace kinecal::detail
