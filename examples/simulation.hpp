// What the examples use to pretend that they had a robot: random numbers and a depth camera.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "kinecal/sensors/depth_camera.hpp"

namespace kinecal::examples {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Random numbers that are the same for a seed everywhere.  (The standard says what mt19937_64
/// gives, but leaves its distributions to each library.)
class SeededRandom {
 public:
  explicit SeededRandom(std::uint64_t seed) : engine_(seed) {}

  [[nodiscard]] double uniform(double lower, double upper) {
    const double unit = static_cast<double>(engine_() >> 11) * 0x1p-53;
    return lower + unit * (upper - lower);
  }

  /// From `first` to `last`, both included.
  [[nodiscard]] int integer(int first, int last) {
    return first + static_cast<int>(uniform(0.0, last - first + 1.0));
  }

  /// Of a size between the two, with either sign.
  [[nodiscard]] double either_sign(double least, double most) {
    const double size = uniform(least, most);
    return uniform(0.0, 1.0) < 0.5 ? -size : size;
  }

  /// Mean 0, standard deviation 1.  Source: Box, Muller, 1958.
  [[nodiscard]] double normal() {
    const double radius = std::sqrt(-2.0 * std::log1p(-uniform(0.0, 1.0)));
    return radius * std::cos(2.0 * std::numbers::pi * uniform(0.0, 1.0));
  }

  /// A unit vector, all directions alike.
  [[nodiscard]] Vector3<double> direction() {
    const double x = normal(), y = normal(), z = normal();
    return Vector3<double>(x, y, z).normalized();
  }

 private:
  std::mt19937_64 engine_;
};

/// 640 x 480 pixels, as its driver has it.
[[nodiscard]] inline CameraInfo example_camera_info() {
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

/// How well a depth camera measures.
struct CameraNoise {
  double pixel = 0.6;    ///< standard deviation, pixels
  double depth = 0.001;  ///< standard deviation at 1 m, metres; it grows with the square
};

/// What the driver reports of a point: a camera with these true parameters, which the driver takes
/// for `camera`.  The inverse of DepthCamera::point, with noise.
/// @param p_camera  (3) the point, metres, in the camera's true optical frame
/// @param v         (6) fx fy cx cy z_offset z_scaling, as DepthCamera has them
/// @returns         (3) metres
[[nodiscard]] inline Vector3<double> recorded_point(const DepthCamera<>& camera,
                                                    const Vector3<double>& p_camera,
                                                    const std::array<double, 6>& v,
                                                    const CameraNoise& noise,
                                                    SeededRandom& random) {
  const double z = p_camera.z();
  const double raw = z / (1.0 + v[5]) - v[4] + noise.depth * z * z * random.normal();
  const double x = camera.fx * (1.0 + v[0]) * p_camera.x() / z + camera.cx * v[2];
  const double y = camera.fy * (1.0 + v[1]) * p_camera.y() / z + camera.cy * v[3];
  const double right = x + noise.pixel * random.normal();
  const double down = y + noise.pixel * random.normal();
  return {right * raw / camera.fx, down * raw / camera.fy, raw};
}

/// True if the camera has the point in its image, not at the edge.
/// @param p_camera  (3) metres, in the optical frame
[[nodiscard]] inline bool is_in_image(const DepthCamera<>& camera,
                                      const Vector3<double>& p_camera) {
  constexpr double kUsed = 0.9;  // of the image
  return p_camera.z() > 0.0 &&
         std::abs(camera.fx * p_camera.x()) < kUsed * camera.cx * p_camera.z() &&
         std::abs(camera.fy * p_camera.y()) < kUsed * camera.cy * p_camera.z();
}

}  // namespace kinecal::examples
