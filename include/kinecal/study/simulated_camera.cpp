// Definitions of simulated_camera.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/simulated_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "kinecal/sensors/depth/depth_polynomial.hpp"
#include "kinecal/sensors/lenses/lens_names.hpp"

namespace kinecal {

CameraInfo typical_camera_info() {
  CameraInfo info;
  info.width = 640;
  info.height = 480;
  info.distortion_model = "plumb_bob";
  info.d = {0.0, 0.0, 0.0, 0.0, 0.0};
  info.k = {554.25, 0, 320.5, 0, 554.25, 240.5, 0, 0, 1};
  info.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  info.p = {554.25, 0, 320.5, 0, 0, 554.25, 240.5, 0, 0, 0, 1, 0};
  return info;
}

namespace detail {
namespace {

/// The camera_info of a pinhole, with or without distortion: pictures are cast along rays (x, y, 1).
/// @throws SettingsError  of another lens
[[nodiscard]] const CameraInfo& pinhole_info(const SimulatedCamera& camera) {
  const std::string lens = is_raw(camera.info, camera.image) ? lens_of(camera.info) : "plumb_bob";
  if (!bends_pinhole(lens)) {
    throw SettingsError(
        "cameras are simulated with pinholes, with or without distortion; the lens " + lens +
        " is not");
  }
  return camera.info;
}

}  // namespace
}  // namespace detail

SimulatedLens::SimulatedLens(const SimulatedCamera& camera)
    : Lens(detail::pinhole_info(camera), camera.image, std::span(camera.errors).first(4)),
      reported_(camera.info, camera.image) {}

namespace detail {
namespace {

/// Normal numbers for the pixels of an image, faster than drawing each: rows start at random places
/// in a table.
class NoiseRows {
 public:
  explicit NoiseRows(SeededRandom& random) : random_(random) {}

  /// Numbers for the next row.
  [[nodiscard]] const float* next(int width) {
    return table().data() + random_.integer(0, static_cast<int>(table().size()) - width - 1);
  }

 private:
  static const std::vector<float>& table() {
    static const std::vector<float> numbers = [] {
      constexpr std::size_t kSize = 1 << 18;
      SeededRandom random(1);
      std::vector<float> all(kSize);
      for (float& number : all) number = static_cast<float>(random.normal());
      return all;
    }();
    return numbers;
  }

  SeededRandom& random_;
};

/// A picture blurred along its rows and transposed.
Image<float> blurred_and_turned(const Image<float>& picture, const std::vector<float>& weights) {
  const int reach = static_cast<int>(weights.size()) - 1, width = picture.width;
  Image<float> turned(picture.height, width);
  for (int v = 0; v < picture.height; ++v) {
    const float* row = &picture.pixels[static_cast<std::size_t>(v) * std::size_t(width)];
    for (int u = 0; u < width; ++u) {
      float sum = weights[0] * row[u];
      for (int k = 1; k <= reach; ++k) {
        const float left = row[std::max(u - k, 0)], right = row[std::min(u + k, width - 1)];
        sum += weights[static_cast<std::size_t>(k)] * (left + right);
      }
      turned(v, u) = sum;
    }
  }
  return turned;
}

/// A picture blurred by the lens.
/// @param sigma  standard deviation of a Gaussian, pixels
Image<float> blurred(const Image<float>& picture, double sigma) {
  constexpr double kLeast = 0.05, kReach = 3.5;
  if (sigma < kLeast) return picture;
  std::vector<float> weights;
  float sum = 0.0F;
  for (int k = 0; k <= static_cast<int>(std::ceil(kReach * sigma)); ++k) {
    weights.push_back(static_cast<float>(std::exp(-0.5 * k * k / (sigma * sigma))));
    sum += (k == 0 ? 1.0F : 2.0F) * weights.back();
  }
  for (float& weight : weights) weight /= sum;
  return blurred_and_turned(blurred_and_turned(picture, weights), weights);
}

GrayImage exposed(const SimulatedCamera& camera, const Image<float>& picture,
                  SeededRandom& random) {
  NoiseRows noise(random);
  const auto gain = static_cast<float>(camera.exposure), sigma = static_cast<float>(camera.noise);
  const Image<float> sharp = blurred(picture, camera.blur);
  GrayImage image(picture.width, picture.height);
  for (int v = 0; v < image.height; ++v) {
    const float* normal = noise.next(image.width);
    for (int u = 0; u < image.width; ++u) {
      const float value = gain * sharp(u, v) + sigma * normal[u] + 0.5F;
      image(u, v) = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
    }
  }
  return image;
}

/// True where the depth around a pixel jumps: structured light and stereo see no texture there.
bool is_at_an_edge(const DepthImage& depth, int u, int v) {
  constexpr float kJump = 0.02F;  // share of the depth
  const float z = depth(u, v);
  for (const auto& [du, dv] : {std::array{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    if (!depth.contains(u + du, v + dv)) continue;
    if (!(std::abs(depth(u + du, v + dv) - z) < kJump * z)) return true;
  }
  return false;
}

/// The depth z1 of which the polynomial makes a true depth.  z = z1 (1 + z_quadratic z1 + p)
double before_polynomial(const SimulatedCamera& camera, const Vector3<double>& ray, double z) {
  const auto bend = std::span(camera.errors).last<kDepthTerms>();
  const double one_and_p = depth_factor(0.0, ray.x(), ray.y(), bend);
  return 2.0 * z / (one_and_p + std::sqrt(one_and_p * one_and_p + 4.0 * bend[0] * z));
}

/// The depth that the driver reports, metres; NaN outside of its range.
/// @param z       true depth, metres
/// @param ray     of the pixel, as reported
/// @param normal  random number
double reported_depth(const SimulatedCamera& camera, double focal_length, double z,
                      const Vector3<double>& ray, double normal) {
  double raw = before_polynomial(camera, ray, z) / (1.0 + camera.errors[5]) - camera.errors[4];
  raw += camera.depth_noise * z * z * normal;
  if (camera.disparity_step > 0.0 && raw > 0.0) {
    const double per_step = focal_length * camera.baseline / camera.disparity_step;
    raw = per_step / std::max(1.0, std::round(per_step / raw));
  }
  return raw >= camera.nearest && raw <= camera.farthest ? raw : std::nan("");
}

PointCloud measured_points(const SimulatedCamera& camera, const SimulatedLens& lens,
                           const Picture& picture, SeededRandom& random) {
  NoiseRows noise(random);
  const double focal_length = 1.0 / (lens.reported_ray(1.0, 0.0) - lens.reported_ray(0, 0)).x();
  PointCloud points(picture.depth.width, picture.depth.height, no_point());
  for (int v = 0; v < points.height; ++v) {
    const float* normal = noise.next(points.width);
    for (int u = 0; u < points.width; ++u) {
      const double z = picture.depth(u, v);
      if (!(z > 0.0)) continue;
      if (camera.has_holes && (picture.answer(u, v) == 0 || is_at_an_edge(picture.depth, u, v))) {
        continue;
      }
      const Vector3<double> ray = lens.reported_ray(u, v);
      const double raw = reported_depth(camera, focal_length, z, ray, normal[u]);
      if (!std::isnan(raw)) points(u, v) = (ray * raw).cast<float>();
    }
  }
  return points;
}

}  // namespace
}  // namespace detail

View photograph(const SimulatedCamera& camera, const SimulatedLens& lens, const Picture& picture,
                SeededRandom& random) {
  View view;
  view.frame = camera.frame;
  view.camera = camera.info;
  view.image = detail::exposed(camera, picture.brightness, random);
  if (camera.has_depth) view.points = detail::measured_points(camera, lens, picture, random);
  return view;
}

}  // namespace kinecal
