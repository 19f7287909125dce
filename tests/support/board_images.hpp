// Pictures of flat targets, rendered by their geometry: boards and tags as a camera would see them.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "kinecal/capture/view.hpp"
#include "kinecal/geometry/pose.hpp"
#include "kinecal/study/seeded_random.hpp"

namespace kinecal::testing {

/// What is printed: brightness (0 to 1) at (x, y) metres of the target; negative beyond its edge.
using Print = std::function<double(double x, double y)>;

/// How a picture is taken.
struct Exposure {
  double blur = 0.5;          ///< of the lens, pixels (standard deviation)
  double noise = 2.0;         ///< of 255 (standard deviation)
  double black = 30.0;        ///< of 255
  double white = 210.0;       ///< of 255
  double background = 130.0;  ///< of 255
  double shade = 0.0;         ///< brightness lost from the left to the right border, 0 to 1
  int motion = 0;             ///< smear to the right, pixels
  unsigned seed = 1;          ///< of the noise
};

/// A target in front of the camera.
struct Target {
  Print print;                  ///< what is printed on it
  Pose<double> camera_T_board;  ///< z forward, x right, y down
};

inline CameraInfo camera_640(double focal_length = 600.0) {
  CameraInfo camera;
  camera.width = 640;
  camera.height = 480;
  camera.p = {focal_length, 0, 319.5, 0, 0, focal_length, 239.5, 0, 0, 0, 1, 0};
  camera.k = {focal_length, 0, 319.5, 0, focal_length, 239.5, 0, 0, 1};
  return camera;
}

/// Where a point of a target appears, pixels.
inline Eigen::Vector2d pixel_of(const CameraInfo& camera, const Pose<double>& camera_T_board,
                                const Vector3<double>& p_board) {
  const Vector3<double> p = camera_T_board * p_board;
  return {camera.p[0] * p.x() / p.z() + camera.p[2], camera.p[5] * p.y() / p.z() + camera.p[6]};
}

/// A target that faces the camera, then turned about the camera's axes (radians), with the point
/// `middle` of the target at `at` (metres, in the camera).
inline Pose<double> facing(const Vector3<double>& at, double tilt_x, double tilt_y, double roll,
                           const Vector3<double>& middle) {
  const Eigen::AngleAxisd rx(tilt_x, Vector3<double>::UnitX()),
      ry(tilt_y, Vector3<double>::UnitY()), rz(roll, Vector3<double>::UnitZ());
  Pose<double> pose;
  pose.rotation = (rx * ry * rz).toRotationMatrix();
  pose.translation = at - pose.rotation * middle;
  return pose;
}

namespace images {

/// Brightness along a ray: of the nearest target that it meets.
inline double ray_value(const std::vector<Target>& targets,
                        const std::vector<Pose<double>>& inverse, const Vector3<double>& ray,
                        const Exposure& how) {
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Vector3<double> from = inverse[i].translation, way = inverse[i].rotation * ray;
    const double t = -from.z() / way.z();
    if (!(t > 0.0)) continue;
    const double value = targets[i].print(from.x() + t * way.x(), from.y() + t * way.y());
    if (value >= 0.0) return how.black + value * (how.white - how.black);
  }
  return how.background;
}

/// One pass of a filter along rows (dx 1) or columns (dx 0).
inline std::vector<double> filtered(const std::vector<double>& in, int width, int height, int dx,
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

inline std::vector<double> gaussian(double sigma) {
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

}  // namespace images

/// The picture of targets: 4 x 4 rays a pixel, then blur, shade and noise.
inline GrayImage picture(const CameraInfo& camera, const std::vector<Target>& targets,
                         const Exposure& how = {}) {
  const int width = camera.width, height = camera.height;
  std::vector<Pose<double>> inverse;
  for (const Target& t : targets) inverse.push_back(t.camera_T_board.inverse());
  std::vector<double> light;
  light.reserve(static_cast<std::size_t>(width * height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      double sum = 0.0;
      for (int k = 0; k < 16; ++k) {
        const double x = u + (k % 4 - 1.5) / 4.0, y = v + (k / 4 - 1.5) / 4.0;
        const Vector3<double> ray((x - camera.p[2]) / camera.p[0], (y - camera.p[6]) / camera.p[5],
                                  1.0);
        sum += images::ray_value(targets, inverse, ray, how);
      }
      light.push_back(sum / 16.0);
    }
  }
  const std::vector<double> lens = images::gaussian(how.blur);
  light = images::filtered(images::filtered(light, width, height, 1, lens), width, height, 0, lens);
  if (how.motion > 0) {
    const auto n = static_cast<std::size_t>(2 * (how.motion / 2) + 1);
    light = images::filtered(light, width, height, 1,
                             std::vector<double>(n, 1.0 / static_cast<double>(n)));
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

/// A checkerboard whose first inner corner is at the origin: dark between the first corners, with a
/// white margin of one square.
inline Print checkerboard(int columns, int rows, double square) {
  return [=](double x, double y) {
    const double a = std::floor(x / square), b = std::floor(y / square);
    if (a < -2 || b < -2 || a > columns || b > rows) return -1.0;
    if (a < -1 || b < -1 || a >= columns || b >= rows) return 1.0;
    return std::fmod(a + b + 8.0, 2.0) == 0.0 ? 0.0 : 1.0;
  };
}

}  // namespace kinecal::testing
