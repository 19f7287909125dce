// Definitions of registered_points.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/capture/registered_points.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kinecal {

namespace {

/// A pixel of the depth image, in the other camera.
struct Vertex {
  double depth = 0.0;  ///< along the axis of the depth camera, metres; 0: none
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< of the other image
  Vector3<double> in_plane =
      Vector3<double>::Zero();  ///< x/z, y/z, 1/z: linear in the pixel, on a plane
};

/// Draws triangles into an image.
class SurfaceImage {
 public:
  SurfaceImage(int width, int height)
      : points_(width, height, no_point()), nearest_(width, height, 0.0) {}

  /// @param is_edge  between two surfaces: hides what is behind it
  void draw(const std::array<Vertex, 3>& corners, bool is_edge) {
    if (!(corners[0].depth > 0.0 && corners[1].depth > 0.0 && corners[2].depth > 0.0)) return;
    Eigen::Vector2d least = corners[0].pixel, most = least;
    Matrix3<double> pixels, values;
    for (int i = 0; i < 3; ++i) {
      const Vertex& corner = corners[static_cast<std::size_t>(i)];
      least = least.cwiseMin(corner.pixel);
      most = most.cwiseMax(corner.pixel);
      pixels.col(i) << corner.pixel, 1.0;
      values.col(i) = corner.in_plane;
    }
    if (!(std::abs(pixels.determinant()) > 1e-9)) return;
    const Matrix3<double> weights = pixels.inverse();
    const auto first = [](double at) { return static_cast<int>(std::ceil(std::max(at, 0.0))); };
    const auto last = [](double at, int size) {
      return static_cast<int>(std::floor(std::min(at, size - 1.0)));
    };
    for (int v = first(least.y()); v <= last(most.y(), points_.height); ++v) {
      for (int u = first(least.x()); u <= last(most.x(), points_.width); ++u) {
        const Vector3<double> weight = weights * Vector3<double>(u, v, 1.0);
        if (weight.minCoeff() < -1e-9) continue;  // outside
        const Vector3<double> at = values * weight;
        if (!(at.z() > nearest_(u, v))) continue;
        nearest_(u, v) = at.z();
        points_(u, v) =
            is_edge ? no_point()
                    : Vector3<double>(at.x() / at.z(), at.y() / at.z(), 1.0 / at.z()).cast<float>();
      }
    }
  }

  [[nodiscard]] PointCloud points() && { return std::move(points_); }

 private:
  PointCloud points_;
  Image<double> nearest_;  ///< 1/z
};

/// The surface that a depth image shows.
class DepthSurface {
 public:
  /// @param depth, from  must outlive this
  DepthSurface(const DepthImage& depth, const RangeCamera& from, const CameraInfo& camera,
               ImageKind image)
      : from_(from),
        own_(from.info, from.image),
        other_(camera, image),
        vertices_(depth.width, depth.height) {
    for (int v = 0; v < depth.height; ++v) {
      for (int u = 0; u < depth.width; ++u) vertices_(u, v) = vertex(u, v, depth(u, v));
    }
  }

  /// Draws a triangle of the pixels (u, v), (u + 1, v), (u, v + 1), or of the other three of this square.
  void draw(int u, int v, bool first, SurfaceImage& to) const {
    std::array<Vertex, 3> corners;
    const std::array<std::array<int, 2>, 3> places = {
        {{u + 1, v}, {u, v + 1}, {first ? u : u + 1, first ? v : v + 1}}};
    double near = 1e300, far = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = vertices_(places[i][0], places[i][1]);
      near = std::min(near, corners[i].depth);
      far = std::max(far, corners[i].depth);
    }
    if (!(near > 0.0)) return;
    // A plane of which the depth camera sees 10 degrees, and noise.
    const double steepest = 6.0 / own_.focal_length() + 0.01;
    const bool is_edge = far > near * (1.0 + steepest);
    // The near surface ends anywhere between these pixels, and hides what is behind it.
    for (std::size_t i = 0; i < 3 && is_edge; ++i) {
      corners[i] = vertex(places[i][0], places[i][1], near);
    }
    to.draw(corners, is_edge);
  }

 private:
  /// A pixel of the depth image, in the other camera; without depth if it is not in front of it.
  [[nodiscard]] Vertex vertex(int u, int v, double z) const {
    if (!(z > 0.0) || !std::isfinite(z)) return {};
    const Vector3<double> ray = own_.ray(u, v);
    const Vector3<double> p = from_.camera_T_depth * Vector3<double>(ray * (z / ray.z()));
    if (!(ray.z() > 0.0) || !(p.z() > 0.0)) return {};
    const Eigen::Vector2d pixel = other_.project(p);
    if (!pixel.allFinite()) return {};
    return {z, pixel, {p.x() / p.z(), p.y() / p.z(), 1.0 / p.z()}};
  }

  const RangeCamera& from_;
  Lens own_, other_;
  Image<Vertex> vertices_;
};

}  // namespace

PointCloud registered_points(const DepthImage& depth, const RangeCamera& from,
                             const CameraInfo& camera, ImageKind image) {
  if (depth.width != from.info.width || depth.height != from.info.height) {
    throw std::invalid_argument("a depth image has " + std::to_string(depth.width) + " x " +
                                std::to_string(depth.height) + " pixels, its camera_info says " +
                                std::to_string(from.info.width) + " x " +
                                std::to_string(from.info.height));
  }
  const DepthSurface surface(depth, from, camera, image);
  SurfaceImage seen(camera.width, camera.height);
  for (int v = 0; v + 1 < depth.height; ++v) {
    for (int u = 0; u + 1 < depth.width; ++u) {
      for (const bool first : {true, false}) surface.draw(u, v, first, seen);
    }
  }
  return std::move(seen).points();
}

}  // namespace kinecal
