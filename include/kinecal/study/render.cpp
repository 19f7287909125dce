// Definitions of render.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/render.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "kinecal/study/casting.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The light that a lens spreads around an LED that shines: a Gaussian as wide as the LED.  No depth
/// is measured where it is bright.
void add_glow(const SimulatedLens& lens, const Flat& flat, Picture& picture) {
  const Vector3<double>& centre = flat.pose.translation;
  const Vector3<double> ray = centre / centre.z();
  const Eigen::Vector2d pixel = lens.project(centre);
  const double radius =
      (lens.project(centre + Vector3<double>(0.5 * flat.patch->width, 0, 0)) - pixel).norm();
  constexpr double kBrightness = 250.0, kLeast = 1.0, kReach = 3.0, kBlind = 1.5;
  const double sigma = std::max(kLeast, radius), strength = kBrightness * flat.cosine(ray);
  const int reach = static_cast<int>(std::ceil(kReach * sigma));
  const int u0 = static_cast<int>(std::lround(pixel.x())),
            v0 = static_cast<int>(std::lround(pixel.y()));
  for (int v = std::max(0, v0 - reach); v <= std::min(v0 + reach, picture.depth.height - 1); ++v) {
    for (int u = std::max(0, u0 - reach); u <= std::min(u0 + reach, picture.depth.width - 1); ++u) {
      const double r = std::hypot(u - pixel.x(), v - pixel.y()) / sigma;
      picture.brightness(u, v) += static_cast<float>(strength * std::exp(-0.5 * r * r));
      if (r < kBlind) picture.answer(u, v) = 0;
    }
  }
}

/// True if nothing hides the middle of an LED that faces the camera.
bool is_visible(const std::vector<Flat>& flats, const Flat& led) {
  const Vector3<double>& centre = led.pose.translation;
  constexpr double kNearest = 0.01, kOnTop = 1e-4;  // metres
  if (!led.is_front() || centre.z() < kNearest) return false;
  return std::none_of(flats.begin(), flats.end(), [&](const Flat& flat) {
    const auto at = flat.meet(centre / centre.z());
    return at && at->z < centre.z() - kOnTop;
  });
}

}  // namespace
}  // namespace detail

Renderer::Renderer(const SimulatedCamera& camera) : lens_(camera), grazing_(camera.grazing) {
  const CameraInfo& info = camera.info;
  constexpr int kMost = 1 << 14;
  if (info.width < 2 || info.height < 2 || info.width > kMost || info.height > kMost) {
    throw std::invalid_argument(
        "a simulated camera needs the size of its images; camera_info says " +
        std::to_string(info.width) + " x " + std::to_string(info.height));
  }
  corners_ = Image<Vector3<double>>(info.width + 1, info.height + 1, Vector3<double>::Zero());
  for (int v = 0; v <= info.height; ++v) {
    for (int u = 0; u <= info.width; ++u) corners_(u, v) = lens_.ray(u - 0.5, v - 0.5);
  }
}

Picture Renderer::render(const Scene& scene, const PoseInCamera& pose_of, int code) const {
  const int width = corners_.width - 1, height = corners_.height - 1;
  Picture picture{Image<float>(width, height),
                  DepthImage(width, height, std::numeric_limits<float>::quiet_NaN()),
                  Image<std::uint8_t>(width, height, 0)};
  const std::vector<detail::Flat> flats = detail::flats_of(scene, pose_of, code);
  detail::Casting(corners_, flats, scene, grazing_, picture).run();
  for (const detail::Flat& flat : flats) {
    if (flat.shines && detail::is_visible(flats, flat)) detail::add_glow(lens_, flat, picture);
  }
  return picture;
}

}  // namespace kinecal
