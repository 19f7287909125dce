// Definitions of led_difference.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/led_difference.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "kinecal/capture/finders/light_blob.hpp"

namespace kinecal {
namespace detail {
namespace {

/// Accumulated differences in a part of the image.
struct LedLight {
  Image<float> light;
  int left = 0, top = 0;                   ///< of the part
  std::optional<PixelCircle> within = {};  ///< where its brightest pixel may be

  /// True if a pixel of the part may be the brightest.
  [[nodiscard]] bool may_be(int u, int v) const {
    return !within || std::hypot(left + u - within->u, top + v - within->v) <= within->radius;
  }
};

/// The pixels around a circle, in the image; an empty box if its center is NaN.
PixelBox led_box(const PixelCircle& circle, int width, int height) {
  const auto pixel = [](double x, int last) {
    return std::isnan(x) ? last + 1 : static_cast<int>(std::clamp(std::floor(x), -1.0, last + 1.0));
  };
  return {std::max(0, pixel(circle.u - circle.radius, width - 1)),
          std::max(0, pixel(circle.v - circle.radius, height - 1)),
          std::min(width - 1, pixel(circle.u + circle.radius + 1.0, width - 1)),
          std::min(height - 1, pixel(circle.v + circle.radius + 1.0, height - 1))};
}

/// The smaller of the means of both halves, times the number of pulses, in a circle and slightly
/// beyond:  a light at its edge must not be cut.
LedLight led_light(const std::array<Image<std::int32_t>, 2>& halves, int pulses,
                   const std::optional<PixelCircle>& within) {
  const int width = halves[0].width, height = halves[0].height;
  PixelBox box{0, 0, width - 1, height - 1};
  constexpr double kAround = 20.0;  // pixels
  if (within) box = led_box({within->u, within->v, within->radius + kAround}, width, height);
  LedLight part;
  if (pulses < 2 || box.right < box.left || box.bottom < box.top) return part;
  part = {Image<float>(box.right - box.left + 1, box.bottom - box.top + 1), box.left, box.top,
          within};
  const int odd_pulses = pulses / 2, even_pulses = pulses - odd_pulses;
  const float even = static_cast<float>(pulses) / static_cast<float>(even_pulses);
  const float odd = static_cast<float>(pulses) / static_cast<float>(odd_pulses);
  for (int v = 0; v < part.light.height; ++v) {
    const std::int32_t* a = &halves[0](box.left, box.top + v);
    const std::int32_t* b = &halves[1](box.left, box.top + v);
    float* sum = &part.light(0, v);
    for (int u = 0; u < part.light.width; ++u) {
      sum[u] = std::min(even * static_cast<float>(a[u]), odd * static_cast<float>(b[u]));
    }
  }
  return part;
}

/// The brightest pixel outside of a box.
LightPixel brightest_pixel(const LedLight& part, const PixelBox& except = {}) {
  const Image<float>& light = part.light;
  LightPixel best{-1, -1};
  float most = 0.0F;
  for (int v = 0; v < light.height; ++v) {
    for (int u = 0; u < light.width; ++u) {
      if (light(u, v) <= most || except.contains(u, v) || !part.may_be(u, v)) continue;
      most = light(u, v);
      best = {u, v};
    }
  }
  return best;
}

/// Doubts about a light that is bright enough; empty if absent.
/// @param whole  the accumulated differences of the whole image
std::string led_doubt(const LightBlob& blob, const LedSpot& spot, const LedLight& part,
                      const Image<std::int32_t>& whole) {
  constexpr double kMostElongated = 2.5, kRival = 0.5;
  constexpr std::size_t kMostOfImage = 50;  // one part in this many
  const std::string size = std::to_string(spot.box.right - spot.box.left + 1) + " x " +
                           std::to_string(spot.box.bottom - spot.box.top + 1) + " pixels";
  if (static_cast<std::size_t>(blob.pixels) > 25 + whole.pixels.size() / kMostOfImage) {
    return "its light covers " + size + ", too many for an LED; is the exposure fixed?";
  }
  if (spot.box.left <= 0 || spot.box.top <= 0 || spot.box.right >= whole.width - 1 ||
      spot.box.bottom >= whole.height - 1) {
    return "its light is cut by the border of the image";
  }
  if (blob.elongation() > kMostElongated) {
    return "its light is elongated, " + size + "; it moves, or is a reflection";
  }
  const int near = 3 + std::max(blob.box.right - blob.box.left, blob.box.bottom - blob.box.top);
  const LightPixel rival = brightest_pixel(part, blob.box.grown(near));
  if (rival.u < 0) return "";
  const double share = static_cast<double>(part.light(rival.u, rival.v)) / spot.peak;
  if (share < kRival) return "";
  const int du = rival.u - static_cast<int>(blob.u), dv = rival.v - static_cast<int>(blob.v);
  return "it is ambiguous: another light, " + std::to_string(static_cast<int>(std::hypot(du, dv))) +
         " pixels away, has " + std::to_string(static_cast<int>(100.0 * share)) +
         " % of its brightness";
}

}  // namespace
}  // namespace detail

void LedDifference::add(const GrayImage& before, const GrayImage& lit, const GrayImage& after) {
  for (Image<std::int32_t>& half : halves_) {
    if (half.empty()) half = Image<std::int32_t>(lit.width, lit.height);
  }
  Image<std::int32_t>& half = halves_[static_cast<std::size_t>(pulses_ % 2)];
  const std::size_t size = half.pixels.size();
  for (const GrayImage* image : {&before, &lit, &after}) {
    if (image->pixels.size() == size && image->width == half.width) continue;
    throw std::invalid_argument("images of a pulse differ in size");
  }
  const std::uint8_t *b = before.pixels.data(), *l = lit.pixels.data(), *a = after.pixels.data();
  std::int32_t* sum = half.pixels.data();
  int strongest = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const int gain = int{l[i]} - int{std::max(b[i], a[i])};
    strongest = std::max(strongest, gain);
    sum[i] += 6 * gain;
  }
  strongest_ = std::max(strongest_, 6 * strongest);
  ++pulses_;
}

LedSpot LedDifference::spot(double threshold, const std::optional<PixelCircle>& within) const {
  LedSpot spot;
  const auto weak = [&] {
    const bool moves = pulses_ > 1 && strongest_ >= threshold;
    return (moves ? "it does not light twice at the same place; it moves or is hidden: its "
                  : "it does not light: its ") +
           std::string("difference is ") + std::to_string(static_cast<int>(spot.peak)) + " after " +
           std::to_string(pulses_) + " pulses, the threshold " +
           std::to_string(static_cast<int>(threshold));
  };
  const detail::LedLight part = detail::led_light(halves_, pulses_, within);
  const LightPixel peak = detail::brightest_pixel(part);
  spot.problem = weak();
  if (peak.u < 0) return spot;
  spot.peak = static_cast<double>(part.light(peak.u, peak.v));
  spot.problem = weak();
  spot.u = part.left + peak.u;
  spot.v = part.top + peak.v;
  if (!(spot.peak >= threshold)) return spot;
  const LightBlob blob = light_blob(part.light, peak);
  spot.u = part.left + blob.u;
  spot.v = part.top + blob.v;
  spot.box = {part.left + blob.box.left, part.top + blob.box.top, part.left + blob.box.right,
              part.top + blob.box.bottom};
  spot.problem = detail::led_doubt(blob, spot, part, halves_[0]);
  return spot;
}

}  // namespace kinecal
