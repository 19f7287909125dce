// Definitions of still_view.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/detect/still_view.hpp"

#include <algorithm>
#include <cstdint>
#include <sstream>

#include "kinecal/capture/finders/image_motion.hpp"
#include "kinecal/capture/session/settling.hpp"

namespace kinecal {
namespace detail {

/// Fraction of the pixels that change by more than noise and light.
[[nodiscard]] inline double change_between(const GrayImage& earlier, const GrayImage& later) {
  if (earlier.width != later.width || earlier.height != later.height) return 1.0;
  ImageMotion motion;
  motion.add(earlier, later);
  return motion.share({0, 0, later.width - 1, later.height - 1});
}

}  // namespace detail

double sharpness(const GrayImage& image) {
  std::int64_t sum = 0;
  for (int v = 1; v < image.height; ++v) {
    for (int u = 1; u < image.width; ++u) {
      const int here = image(u, v);
      const int dx = here - image(u - 1, v), dy = here - image(u, v - 1);
      sum += dx * dx + dy * dy;
    }
  }
  return image.empty() ? 0.0 : static_cast<double>(sum) / static_cast<double>(image.pixels.size());
}

StillView still_view(std::span<const View> views) {
  const std::size_t middle = views.size() / 2;
  if (views.size() < 2 || views.front().image.empty()) return {middle, {}};
  std::size_t first = 0, length = 1, run = 0;
  double least = 1.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double change = detail::change_between(views[i - 1].image, views[i].image);
    least = std::min(least, change);
    if (change > SettleOptions{}.still_pixels) run = i;
    if (i + 1 - run <= length) continue;
    first = run;
    length = i + 1 - run;
  }
  if (length < 2) {
    std::ostringstream text;
    text.precision(2);
    text << "the image moves although the joints stand still: at least " << 100.0 * least
         << " % of its pixels change from one to the next";
    return {0, text.str()};
  }
  StillView chosen{first + length / 2, {}};
  constexpr double kClearly = 1.1;
  double sharpest = kClearly * sharpness(views[chosen.index].image);
  for (std::size_t i = first; i < first + length; ++i) {
    const double own = sharpness(views[i].image);
    if (own <= sharpest) continue;
    sharpest = own;
    chosen.index = i;
  }
  return chosen;
}

}  // namespace kinecal
