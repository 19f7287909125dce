// The triangles of one link, in a tree of boxes: the nearest point of the surface, and what a ray hits first.
//
// Each node has the boxes of four children, each leaf four triangles, one per lane of a vector of floats: they only
// choose the triangle; the point on it is computed in double.
// Source: C. Ericson, Real-Time Collision Detection, 2005, 5.1.5 and 6.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "kinecal/files/meshes/mesh.hpp"
#include "kinecal/geometry/pose.hpp"

namespace kinecal {

/// A point of a surface, in the frame of its triangles.
struct SurfacePoint {
  Vector3<double> point = Vector3<double>::Zero();  ///< (3) metres
  Vector3<double> normal =
      Vector3<double>::UnitZ();  ///< (3) unit vector, outward as the corners turn
  int triangle = -1;             ///< number in the tree; a start for the next search
  double distance =
      std::numeric_limits<double>::infinity();  ///< metres: to the point, or along the ray
};

/// What is known of a surface beside its shape.
struct SurfaceFacts {
  std::size_t triangles = 0;     ///< with an area
  std::size_t without_area = 0;  ///< left out
  bool closed = false;           ///< each edge belongs to two triangles that turn alike
  double volume = 0.0;           ///< m^3; of a closed surface: negative if it is inside out
  Vector3<double> low = Vector3<double>::Zero();   ///< (3) corner of the box about it, metres
  Vector3<double> high = Vector3<double>::Zero();  ///< (3) the other corner
};

/// Triangles in a tree of boxes.
class TriangleTree {
 public:
  /// @param vertices   metres, finite
  /// @param triangles  three vertices of each
  TriangleTree(const std::vector<Vector3<double>>& vertices,
               const std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// Number of triangles, its box, whether it is closed.
  [[nodiscard]] const SurfaceFacts& facts() const { return facts_; }
  /// How many triangles have a number; some occur twice, so that leaves are full.
  [[nodiscard]] int count() const { return static_cast<int>(triangles_.size()); }
  /// The corners of a triangle.
  [[nodiscard]] const std::array<Vector3<double>, 3>& corners(int triangle) const {
    return triangles_[static_cast<std::size_t>(triangle)].corners;
  }
  /// The middle of the tree's box and the distance from there to its corners, metres.
  /// @{
  [[nodiscard]] Vector3<double> center() const { return 0.5 * (facts_.low + facts_.high); }
  [[nodiscard]] double radius() const { return 0.5 * (facts_.high - facts_.low).norm(); }
  /// @}
  /// How far a point is from that box, metres; the surface is no nearer.
  [[nodiscard]] double away(const Vector3<double>& p) const;

  /// The nearest point of the surface.
  /// @param p      (3) metres
  /// @param bound  metres; farther points do not count
  /// @param guess  a triangle that is probably near; negative: unknown
  /// @returns      nullopt if the surface is farther away than the bound
  [[nodiscard]] std::optional<SurfacePoint> closest(
      const Vector3<double>& p, double bound = std::numeric_limits<double>::infinity(),
      int guess = -1) const;
  /// The same on one triangle.
  [[nodiscard]] SurfacePoint on_triangle(const Vector3<double>& p, int triangle) const;

  /// What a ray hits first, from either side.
  /// @param origin     (3) metres
  /// @param direction  (3) of any length; distances are in its lengths
  /// @param bound      in lengths of the direction
  [[nodiscard]] std::optional<SurfacePoint> cast(
      const Vector3<double>& origin, const Vector3<double>& direction,
      double bound = std::numeric_limits<double>::infinity()) const;

 private:
  static constexpr int kWide = 4;
  using Lanes = float __attribute__((vector_size(16)));

  struct Triangle {
    std::array<Vector3<double>, 3> corners;
    Vector3<double> normal;
  };
  /// Boxes of four children.
  struct Node {
    std::array<Lanes, 3> low, high;
    std::array<int, kWide> child;  ///< a node, ~ of a leaf; an absent child has a box at infinity
  };
  /// Four triangles: a corner, two edges, and what projects a point on them.
  struct Leaf {
    std::array<Lanes, 3> a, ab, ac;
    Lanes g00, g01, g11;        ///< inverse of the products of the edges
    Lanes ab_ab, ac_ac, bc_bc;  ///< one over the squared lengths of the edges
  };
  struct Box;
  class Build;
  class Open;

  /// Squared distances of a point from the triangles of a leaf.
  /// @param at  (3) the same in all lanes
  [[nodiscard]] static Lanes squares(const std::array<Lanes, 3>& at, const Leaf& leaf);

  void find_facts(std::span<const std::array<std::uint32_t, 3>> corners);

  SurfaceFacts facts_;
  std::vector<Triangle> triangles_;  ///< in the order of the leaves
  std::vector<Node> nodes_;          ///< [0] is the root
  std::vector<Leaf> leaves_;
};

}  // namespace kinecal
