// The outline of a posed robot in an image: where its surface ends against what is behind it.
//
// An edge of a mesh belongs to it if one of its triangles faces the camera, the other does not, and just beyond the edge
// nothing of the robot is in the image.  If a link moves, its outline moves as its points there do, along the normal: where
// the outline slides on a round surface, it slides along the line of sight.  So a point of the outline counts as one of the
// link.
// Source: Forsyth, Ponce, Computer Vision: A Modern Approach, 2012, 13.1, outlines of smooth surfaces.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "kinecal/capture/finders/mask_finder.hpp"
#include "kinecal/surface/robot_surface.hpp"

namespace kinecal {

namespace detail {
class Raster;
}

/// The pixel (2) at which a camera sees a point (3) of its frame, metres; NaN where it does not see it.
using PixelOf = std::function<Eigen::Vector2d(const Vector3<double>&)>;

/// A point of an outline.
struct OutlinePoint {
  Eigen::Vector2d pixel;   ///< (2)
  Eigen::Vector2d normal;  ///< (2) unit vector in the image, away from the robot
  int link = -1;           ///< number of the link in the surface
  Vector3<double> point;   ///< (3) metres, in the link
};

/// Finds outlines of a robot.
class Outliner {
 public:
  /// @param triangles  of a link, at most: a larger mesh is simplified, as for viewers
  explicit Outliner(const RobotSurface& surface,
                    std::size_t triangles = std::numeric_limits<std::size_t>::max());

  /// The outline in an image: about one point per pixel of its length, none within kMaskBorder of the border.
  /// @param camera_T_links  poses of the links of the surface, in their order
  [[nodiscard]] std::vector<OutlinePoint> outline(std::span<const Pose<double>> camera_T_links,
                                                  const PixelOf& pixel_of, int width,
                                                  int height) const;
  /// The robot in an image: 255 where it is seen, else 0.
  [[nodiscard]] GrayImage mask(std::span<const Pose<double>> camera_T_links,
                               const PixelOf& pixel_of, int width, int height) const;

 private:
  /// Two corners, and the triangles on both sides: the same twice at the end of a surface.
  struct Edge {
    std::array<std::uint32_t, 2> corners;
    std::array<std::uint32_t, 2> triangles;
  };
  struct Link {
    std::vector<Vector3<double>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<Vector3<double>> normals;  ///< of the triangles, of any length
    std::vector<Edge> edges;
    bool closed = false;
  };

  /// A link in an image.
  struct Posed {
    std::vector<Eigen::Vector2d> pixels;  ///< of its vertices
    std::vector<char> faces;              ///< of each triangle: one if it faces the camera
  };
  [[nodiscard]] std::vector<Posed> posed(std::span<const Pose<double>> camera_T_links,
                                         const PixelOf& pixel_of) const;
  void draw(const std::vector<Posed>& posed, detail::Raster& raster) const;

  std::vector<Link> links_;
};

/// Points in an image, to be found by their neighbours.
class PixelGrid {
 public:
  /// @param pixels  (2) each, in or near the image
  PixelGrid(std::vector<Eigen::Vector2d> pixels, int width, int height);

  /// Number of the nearest point for which `fits` is true; negative if there is none.
  /// @param bound  pixels; farther ones do not count
  template <class Fits>
  [[nodiscard]] int nearest(const Eigen::Vector2d& at, double bound, const Fits& fits) const {
    const auto cell = [](double x, int cells) {
      return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, cells - 1);
    };
    const int cu = cell(at.x(), columns_), cv = cell(at.y(), rows_);
    double least = bound * bound;
    int found = -1;
    const auto search = [&](int u, int v) {
      if (u < 0 || v < 0 || u >= columns_ || v >= rows_) return;
      const auto c = static_cast<std::size_t>(v * columns_ + u);
      for (int i = first_[c]; i < first_[c + 1]; ++i) {
        const double d =
            (pixels_[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])] - at)
                .squaredNorm();
        if (d > least || (d == least && found >= 0)) continue;
        if (!fits(order_[static_cast<std::size_t>(i)])) continue;
        least = d;
        found = order_[static_cast<std::size_t>(i)];
      }
    };
    const int most = std::max(columns_, rows_);
    for (int ring = 0; ring <= most; ++ring) {
      const double nearest_there = (ring - 1) * kCell;  // of what is outside of the rings before
      if (ring > 1 && nearest_there * nearest_there > least) break;
      for (int u = cu - ring; u <= cu + ring; ++u) {
        search(u, cv - ring);
        if (ring > 0) search(u, cv + ring);
      }
      for (int v = cv - ring + 1; v < cv + ring; ++v) {
        search(cu - ring, v);
        search(cu + ring, v);
      }
    }
    return found;
  }

 private:
  static constexpr double kCell = 8.0;  ///< pixels

  int columns_, rows_;
  std::vector<Eigen::Vector2d> pixels_;
  std::vector<int> first_, order_;  ///< of the points in a cell
};

}  // namespace kinecal
