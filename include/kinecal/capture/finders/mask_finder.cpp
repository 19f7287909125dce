// Definitions of mask_finder.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/finders/mask_finder.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] bool is_away_from_border(const Eigen::Vector2d& at, const GrayImage& image) {
  return at.x() >= kMaskBorder && at.y() >= kMaskBorder &&
         at.x() <= image.width - 1 - kMaskBorder && at.y() <= image.height - 1 - kMaskBorder;
}

/// Sums of pixels over rectangles from the upper left corner.
class Sums {
 public:
  explicit Sums(const GrayImage& mask) : sums_(mask.width + 1, mask.height + 1, 0) {
    for (int v = 0; v < mask.height; ++v) {
      for (int u = 0; u < mask.width; ++u) {
        const int here = mask(u, v) >= 128 ? 1 : 0;
        sums_(u + 1, v + 1) = here + sums_(u, v + 1) + sums_(u + 1, v) - sums_(u, v);
      }
    }
  }
  /// Number of pixels of the robot in a rectangle, its end not included; what is outside of the image is not.
  [[nodiscard]] int in(int u0, int v0, int u1, int v1) const {
    const auto within = [](int x, int size) { return std::clamp(x, 0, size - 1); };
    const int a = within(u0, sums_.width), b = within(u1, sums_.width),
              c = within(v0, sums_.height), d = within(v1, sums_.height);
    return sums_(b, d) - sums_(a, d) - sums_(b, c) + sums_(a, c);
  }

 private:
  Image<int> sums_;
};

/// The direction in which a mask falls off at a place, from a square of pixels around it.
[[nodiscard]] Eigen::Vector2d falling(const Sums& sums, const Eigen::Vector2d& at,
                                      const Eigen::Vector2d& across) {
  constexpr int kAround = 3;  // pixels
  const int u = static_cast<int>(std::ceil(at.x())), v = static_cast<int>(std::ceil(at.y()));
  const Eigen::Vector2d normal(sums.in(u - kAround, v - kAround, u, v + kAround) -
                                   sums.in(u, v - kAround, u + kAround, v + kAround),
                               sums.in(u - kAround, v - kAround, u + kAround, v) -
                                   sums.in(u - kAround, v, u + kAround, v + kAround));
  return normal.norm() > 0.0 ? Eigen::Vector2d(normal.normalized()) : across;
}

}  // namespace
}  // namespace detail

std::vector<MaskEdge> mask_edges(const GrayImage& mask) {
  const detail::Sums sums(mask);
  std::vector<MaskEdge> edges;
  for (int v = 0; v < mask.height; ++v) {
    for (int u = 0; u < mask.width; ++u) {
      const bool here = mask(u, v) >= 128;
      for (const auto& [du, dv] : {std::pair(1, 0), std::pair(0, 1)}) {
        if (!mask.contains(u + du, v + dv) || here == (mask(u + du, v + dv) >= 128)) continue;
        const Eigen::Vector2d pixel(u + 0.5 * du, v + 0.5 * dv);
        if (!detail::is_away_from_border(pixel, mask)) continue;
        const Eigen::Vector2d across = (here ? 1.0 : -1.0) * Eigen::Vector2d(du, dv);
        edges.push_back({pixel, detail::falling(sums, pixel, across)});
      }
    }
  }
  return edges;
}

std::string MaskFinder::fault(const View& view) {
  const GrayImage& mask = view.image;
  if (mask.empty()) return "the view has no image";
  if (view.camera && (view.camera->width != mask.width || view.camera->height != mask.height)) {
    return "the mask has " + std::to_string(mask.width) + " x " + std::to_string(mask.height) +
           " pixels, the camera " + std::to_string(view.camera->width) + " x " +
           std::to_string(view.camera->height);
  }
  const auto is_shade = [](std::uint8_t pixel) { return pixel > 64 && pixel < 192; };
  const auto shades = std::count_if(mask.pixels.begin(), mask.pixels.end(), is_shade);
  if (20 * shades > std::ssize(mask.pixels)) {
    return "this is no mask: " + std::to_string(100 * shades / std::ssize(mask.pixels)) +
           " % of its pixels are neither dark nor bright; robot is 255, all else 0";
  }
  return "";
}

Found MaskFinder::find(const View& view) const {
  if (const std::string why = fault(view); !why.empty()) return refused(why);
  const GrayImage& mask = view.image;
  std::size_t bright = 0, around = 0;
  for (int v = 0; v < mask.height; ++v) {
    for (int u = 0; u < mask.width; ++u) {
      if (u > 0 && v > 0 && u + 1 < mask.width && v + 1 < mask.height) continue;
      ++around;
      if (mask(u, v) >= 128) ++bright;
    }
  }
  if (10 * bright > 7 * around) {
    return refused(
        "most of the border of the mask is robot: is it inverted? Robot is 255, all else 0");
  }
  constexpr std::size_t kFewest = 20;
  const std::vector<MaskEdge> edges = mask_edges(mask);
  if (edges.size() < kFewest) {
    return refused("the mask has " + std::to_string(edges.size()) +
                   " edges between robot and not; at least " + std::to_string(kFewest) +
                   " are needed");
  }
  Found found;
  Observation& seen = found.observations.emplace_back();
  seen.sensor = camera_sensor;
  seen.camera = view.camera;
  for (const MaskEdge& edge : edges) {
    Feature& feature = seen.features.emplace_back();
    feature.frame = view.frame;
    feature.point = {edge.pixel.x(), edge.pixel.y(), 0.0};
    feature.conditions = {{"nu", edge.normal.x()}, {"nv", edge.normal.y()}};
    found.marks.push_back({edge.pixel.x(), edge.pixel.y()});
  }
  return found;
}

}  // namespace kinecal
