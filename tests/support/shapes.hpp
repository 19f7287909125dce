// Shapes made of triangles, for tests: boxes and bumpy balls.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "kinecal/geometry/rotation.hpp"
#include "support/meshes.hpp"

namespace kinecal::test {

/// Vertices and triangles, outward.
struct Shape {
  std::vector<Vector3<double>> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  /// As the triangles of a mesh file.
  [[nodiscard]] std::vector<Triangle> for_file() const {
    std::vector<Triangle> all;
    for (const auto& corners : triangles) {
      Triangle& one = all.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          one[k][axis] = static_cast<float>(vertices[corners[k]][static_cast<Eigen::Index>(axis)]);
        }
      }
    }
    return all;
  }
};

/// A box from one corner to the other.
inline Shape box(const Vector3<double>& low, const Vector3<double>& high) {
  Shape shape;
  for (int i = 0; i < 8; ++i) {
    shape.vertices.emplace_back((i & 1) != 0 ? high.x() : low.x(),
                                (i & 2) != 0 ? high.y() : low.y(),
                                (i & 4) != 0 ? high.z() : low.z());
  }
  const std::array<std::array<std::uint32_t, 4>, 6> faces = {
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : faces) {
    shape.triangles.push_back({a, b, c});
    shape.triangles.push_back({a, c, d});
  }
  return shape;
}

/// A ball with bumps, closed: `rings` times `2 rings` patches.
/// @param bumps  part of the radius; 0: a sphere
inline Shape ball(const Vector3<double>& center, double radius, std::uint32_t rings,
                  double bumps = 0.0) {
  Shape shape;
  const std::uint32_t around = 2 * rings;
  const auto add = [&](double latitude, double longitude) {
    const double r = radius * (1.0 + bumps * std::sin(5.0 * longitude) * std::sin(4.0 * latitude));
    shape.vertices.push_back(center + r * Vector3<double>(std::sin(latitude) * std::cos(longitude),
                                                          std::sin(latitude) * std::sin(longitude),
                                                          std::cos(latitude)));
  };
  add(0.0, 0.0);
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      add(std::numbers::pi * i / rings, 2.0 * std::numbers::pi * j / around);
    }
  }
  add(std::numbers::pi, 0.0);
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return 1 + (i - 1) * around + j % around;
  };
  const std::uint32_t last = 1 + (rings - 1) * around;
  for (std::uint32_t j = 0; j < around; ++j) {
    shape.triangles.push_back({0, at(1, j), at(1, j + 1)});
    shape.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      shape.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      shape.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return shape;
}

}  // namespace kinecal::test
