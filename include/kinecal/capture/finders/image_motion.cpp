// Definitions of image_motion.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/image_motion.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

#include "kinecal/capture/finders/spread.hpp"

namespace kinecal {
namespace detail {
namespace {

/// Changes of pixels that noise and light explain, grey levels.
struct UsualChange {
  int middle;  ///< of the whole image
  int limit;   ///< of the rest
};

/// Index at which half of the counts are reached.
template <std::size_t N>
int median_index(const std::array<int, N>& counts, int total) {
  int sum = 0;
  for (std::size_t i = 0; i < N; ++i) {
    sum += counts[i];
    if (2 * sum >= total) return static_cast<int>(i);
  }
  return static_cast<int>(N) - 1;
}

UsualChange usual_change(const GrayImage& earlier, const GrayImage& later) {
  constexpr std::size_t kPixels = 5000;
  std::array<int, 511> changes{}, deviations{};
  const std::vector<std::size_t> some = thinned(earlier.pixels.size(), kPixels);
  const auto total = static_cast<int>(some.size());
  const auto change = [&](std::size_t i) { return int{later.pixels[i]} - int{earlier.pixels[i]}; };
  for (const std::size_t i : some) {
    const int of_zero = change(i) + 255;
    ++changes[static_cast<std::size_t>(of_zero)];
  }
  const int middle = median_index(changes, total) - 255;
  for (const std::size_t i : some) {
    ++deviations[static_cast<std::size_t>(std::min(510, std::abs(change(i) - middle)))];
  }
  // Five standard deviations of the noise; more than 40 levels is motion, not noise.
  const double sigma = 1.4826 * median_index(deviations, total);
  return {middle, std::clamp(static_cast<int>(5.0 * sigma), 20, 40)};
}

}  // namespace
}  // namespace detail

void ImageMotion::add(const GrayImage& earlier, const GrayImage& later) {
  if (changed_.empty()) changed_ = GrayImage(earlier.width, earlier.height);
  const std::size_t size = changed_.pixels.size();
  if (earlier.pixels.size() != size || later.pixels.size() != size ||
      earlier.width != changed_.width || later.width != changed_.width) {
    throw std::invalid_argument("images to compare differ in size");
  }
  const auto [middle, limit] = detail::usual_change(earlier, later);
  const std::uint8_t *a = earlier.pixels.data(), *b = later.pixels.data();
  std::uint8_t* changed = changed_.pixels.data();
  for (std::size_t i = 0; i < size; ++i) {
    const int change = int{b[i]} - int{a[i]} - middle;
    changed[i] |= static_cast<std::uint8_t>(change > limit || change < -limit);
  }
}

double ImageMotion::share(const PixelBox& box, const PixelBox& except) const {
  int all = 0, changed = 0;
  for (int v = std::max(0, box.top); v <= std::min(changed_.height - 1, box.bottom); ++v) {
    for (int u = std::max(0, box.left); u <= std::min(changed_.width - 1, box.right); ++u) {
      if (except.contains(u, v)) continue;
      ++all;
      changed += changed_(u, v);
    }
  }
  return all > 0 ? static_cast<double>(changed) / all : 0.0;
}

}  // namespace kinecal
