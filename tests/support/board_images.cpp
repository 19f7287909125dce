#include "support/board_images.hpp"

#include <algorithm>
#include <cmath>

#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal::test {

namespace {

/// How far along a ray the paper of a target is; not above zero if it is not there.
/// @param from, way  (3) in the target
double distance_of(const Target& target, const Vector3<double>& from, const Vector3<double>& way) {
  double t = -from.z() / way.z();
  constexpr int kSteps = 8;  // of a fixed point: paper is seen from above
  for (int n = 0; n < kSteps && target.bend; ++n) {
    t = (target.bend(from.x() + t * way.x(), from.y() + t * way.y()) - from.z()) / way.z();
  }
  return t;
}

/// Brightness along a ray: of the nearest target that it meets.
double ray_value(const std::vector<Target>& targets, const std::vector<Pose<double>>& inverse,
                 const Vector3<double>& ray, const Exposure& how) {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Vector3<double> from = inverse[i].translation, way = inverse[i].rotation * ray;
    const double t = distance_of(targets[i], from, way);
    if (!(t > 0.0)) continue;
    const double value = targets[i].print(from.x() + t * way.x(), from.y() + t * way.y());
    if (value >= 0.0) return how.black + value * (how.white - how.black);
  }
  return how.background;
}

/// One pass of a filter along rows (dx 1) or columns (dx 0).
std::vector<double> filtered(const std::vector<double>& in, int width, int height, int dx,
                             const std::vector<double>& weights) {
  const int reach = static_cast<int>(weights.size()) / 2;
  std::vector<double> out(in.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      double sum = 0.0;
      for (int k = -reach; k <= reach; ++k) {
        const int a = std::clamp(u + dx * k, 0, width - 1);
        const int b = std::clamp(v + (1 - dx) * k, 0, height - 1);
        sum += weights[static_cast<std::size_t>(k + reach)] *
               in[static_cast<std::size_t>(b * width + a)];
      }
      out[static_cast<std::size_t>(v * width + u)] = sum;
    }
  }
  return out;
}

std::vector<double> gaussian(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(4.0 * sigma)));
  std::vector<double> weights;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(sigma > 0.0 ? std::exp(-0.5 * k * k / (sigma * sigma)) : k == 0 ? 1.0 : 0.0);
    sum += weights.back();
  }
  for (double& w : weights) w /= sum;
  return weights;
}

}  // namespace

GrayImage picture(const CameraInfo& camera, const std::vector<Target>& targets,
                  const Exposure& how) {
  const int width = camera.width, height = camera.height;
  std::vector<Pose<double>> inverse;
  for (const Target& t : targets) inverse.push_back(t.camera_T_board.inverse());
  const Lens lens(camera);
  std::vector<double> light;
  light.reserve(static_cast<std::size_t>(width * height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const Vector3<double> first = lens.ray(u - 0.5, v - 0.5);
      const Vector3<double> right = lens.ray(u + 0.5, v - 0.5) - first,
                            down = lens.ray(u - 0.5, v + 0.5) - first;
      if (!first.allFinite() || !right.allFinite() || !down.allFinite()) {
        light.push_back(0.0);  // beyond the circle of a fisheye
        continue;
      }
      double sum = 0.0;
      for (int k = 0; k < 16; ++k) {
        const Vector3<double> ray =
            first + (k % 4 + 0.5) / 4.0 * right + (k / 4 + 0.5) / 4.0 * down;
        sum += ray_value(targets, inverse, ray, how);
      }
      light.push_back(sum / 16.0);
    }
  }
  const std::vector<double> weights = gaussian(how.blur);
  light = filtered(filtered(light, width, height, 1, weights), width, height, 0, weights);
  if (how.motion > 0) {
    const auto n = static_cast<std::size_t>(2 * (how.motion / 2) + 1);
    light = filtered(light, width, height, 1, std::vector<double>(n, 1.0 / static_cast<double>(n)));
  }
  SeededRandom random(how.seed);
  GrayImage image(width, height);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double u = static_cast<double>(i % static_cast<std::size_t>(width));
    const double lit = light[i] * (1.0 - how.shade * u / width) + how.noise * random.normal();
    image.pixels[i] = static_cast<std::uint8_t>(std::clamp(std::lround(lit), 0L, 255L));
  }
  return image;
}

Print checkerboard(int columns, int rows, double square, double border) {
  return [=](double x, double y) {
    const double u = x / square, v = y / square;
    const double beyond = std::max({-u, -v, u - (columns - 1), v - (rows - 1)});
    if (beyond > border + 1.0) return -1.0;
    if (beyond > border) return 1.0;
    return std::fmod(std::floor(u) + std::floor(v) + 8.0, 2.0) == 0.0 ? 0.0 : 1.0;
  };
}

}  // namespace kinecal::test
