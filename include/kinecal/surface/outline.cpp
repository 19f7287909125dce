// Definitions of outline.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/surface/outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "kinecal/files/meshes/read_mesh.hpp"

namespace kinecal {

namespace detail {

/// Where triangles of the robot are in an image, with two samples along a pixel.
class Raster {
 public:
  Raster(int width, int height)
      : width_(kPerPixel * width),
        height_(kPerPixel * height),
        samples_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0) {}

  void add(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
    const double turn = cross(b - a, c - a);
    if (turn == 0.0) return;
    const double sign = turn > 0.0 ? 1.0 : -1.0;
    const auto range = [](double p, double q, double r, int size) {
      const double low = std::min({p, q, r}), high = std::max({p, q, r});
      return std::pair(
          std::max(0, static_cast<int>(std::ceil(place(std::max(low, -1.0))))),
          std::min(size - 1, static_cast<int>(std::floor(place(std::min(high, 1.0 + size))))));
    };
    const auto [u0, u1] = range(a.x(), b.x(), c.x(), width_);
    const auto [v0, v1] = range(a.y(), b.y(), c.y(), height_);
    if (u0 > u1 || v0 > v1) return;
    // A sample is inside if its distances from the three sides are not negative: from one column of a row to another.
    const std::array<std::pair<const Eigen::Vector2d*, const Eigen::Vector2d*>, 3> sides = {
        {{&a, &b}, {&b, &c}, {&c, &a}}};
    std::array<double, 3> at, by_u, by_v;  // times the lengths of the sides
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector2d side = sign * (*sides[k].second - *sides[k].first);
      at[k] = cross(side, Eigen::Vector2d(middle(u0), middle(v0)) - *sides[k].first);
      by_u[k] = -side.y() / kPerPixel;
      by_v[k] = side.x() / kPerPixel;
    }
    for (int v = v0; v <= v1; ++v) {
      double first = 0.0, last = u1 - u0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double from = at[k] + (v - v0) * by_v[k];
        if (by_u[k] > 0.0) {
          first = std::max(first, std::ceil(-from / by_u[k]));
        } else if (by_u[k] < 0.0) {
          last = std::min(last, std::floor(-from / by_u[k]));
        } else if (from < 0.0) {
          last = -1.0;
        }
      }
      if (first > last) continue;
      const auto begin = samples_.begin() + static_cast<std::ptrdiff_t>(index(u0, v));
      std::fill(begin + static_cast<std::ptrdiff_t>(first),
                begin + static_cast<std::ptrdiff_t>(last) + 1, 255);
    }
  }

  /// True if the sample nearest to a pixel is of the robot.
  [[nodiscard]] bool at(const Eigen::Vector2d& pixel) const {
    const int u = static_cast<int>(std::lround(place(pixel.x()))),
              v = static_cast<int>(std::lround(place(pixel.y())));
    return u >= 0 && v >= 0 && u < width_ && v < height_ && samples_[index(u, v)] != 0;
  }

  /// The samples at the middles of pixels; of the four around it, the upper left.
  [[nodiscard]] GrayImage image() const {
    GrayImage image(width_ / kPerPixel, height_ / kPerPixel, 0);
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        image(u, v) = samples_[index(kPerPixel * u + u % 2, kPerPixel * v + v % 2)];
      }
    }
    return image;
  }

 private:
  static constexpr int kPerPixel = 2;

  [[nodiscard]] static double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  }
  /// The sample at a coordinate in pixels, and the other way round.
  /// @{
  [[nodiscard]] static double place(double pixel) { return kPerPixel * (pixel + 0.5) - 0.5; }
  [[nodiscard]] static double middle(int sample) { return (sample + 0.5) / kPerPixel - 0.5; }
  /// @}
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(u);
  }

  int width_, height_;
  std::vector<std::uint8_t> samples_;
};

namespace {

using Corners = std::array<std::uint32_t, 3>;

/// Vertices, and triangles between them.
struct TriangleList {
  std::vector<Vector3<double>> vertices;
  std::vector<Corners> triangles;
};

/// The triangles of a link; those that meet have vertices in common.
[[nodiscard]] TriangleList triangles_of(const TriangleTree& tree) {
  TriangleList list;
  std::map<std::tuple<double, double, double>, std::uint32_t> numbers;
  const auto number_of = [&](const Vector3<double>& p) {
    const auto [known, is_new] = numbers.emplace(std::tuple(p.x(), p.y(), p.z()),
                                                 static_cast<std::uint32_t>(list.vertices.size()));
    if (is_new) list.vertices.push_back(p);
    return known->second;
  };
  std::set<Corners> known;  // trees have some triangles twice
  for (int t = 0; t < tree.count(); ++t) {
    const auto& corners = tree.corners(t);
    Corners c = {number_of(corners[0]), number_of(corners[1]), number_of(corners[2])};
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    if (known.insert(c).second) list.triangles.push_back(c);
  }
  return list;
}

/// The same with fewer triangles.
[[nodiscard]] TriangleList simplified(const TriangleList& list, std::size_t triangles) {
  if (list.triangles.size() <= triangles) return list;
  Mesh mesh;
  for (const Vector3<double>& vertex : list.vertices) {
    for (const double x : vertex) mesh.vertices.push_back(static_cast<float>(x));
  }
  for (const Corners& corners : list.triangles) {
    mesh.triangles.insert(mesh.triangles.end(), corners.begin(), corners.end());
  }
  mesh = thinned(mesh, triangles);
  TriangleList simple;
  for (std::size_t v = 0; v < mesh.num_vertices(); ++v) {
    const float* x = &mesh.vertices[3 * v];
    simple.vertices.emplace_back(x[0], x[1], x[2]);
  }
  for (std::size_t t = 0; t < mesh.num_triangles(); ++t) {
    const std::uint32_t* c = &mesh.triangles[3 * t];
    simple.triangles.push_back({c[0], c[1], c[2]});
  }
  return simple;
}

/// True if a pixel is farther than kMaskBorder from the border of an image.
[[nodiscard]] bool is_inside(const Eigen::Vector2d& at, int width, int height) {
  return at.x() >= kMaskBorder && at.y() >= kMaskBorder && at.x() <= width - 1 - kMaskBorder &&
         at.y() <= height - 1 - kMaskBorder;
}

}  // namespace
}  // namespace detail

Outliner::Outliner(const RobotSurface& surface, std::size_t triangles) {
  for (const SurfaceLink& of : surface.links()) {
    Link& link = links_.emplace_back();
    detail::TriangleList list = detail::simplified(detail::triangles_of(of.tree), triangles);
    link.vertices = std::move(list.vertices);
    link.triangles = std::move(list.triangles);
    const bool is_inside_out = of.tree.facts().closed && of.tree.facts().volume < 0.0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t>
        open;  // edges with one triangle
    for (std::uint32_t t = 0; t < link.triangles.size(); ++t) {
      const detail::Corners& c = link.triangles[t];
      const Vector3<double>& a = link.vertices[c[0]];
      const Vector3<double> normal = (link.vertices[c[1]] - a).cross(link.vertices[c[2]] - a);
      link.normals.push_back(is_inside_out ? Vector3<double>(-normal) : normal);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = c[k], to = c[(k + 1) % 3];
        const auto other = open.find({to, from});
        if (other != open.end()) {
          link.edges.push_back({{from, to}, {t, other->second}});
          open.erase(other);
        } else {
          open.emplace(std::pair(from, to), t);
        }
      }
    }
    link.closed = open.empty();
    for (const auto& [corners, t] : open) {
      link.edges.push_back({{corners.first, corners.second}, {t, t}});
    }
  }
}

std::vector<Outliner::Posed> Outliner::posed(std::span<const Pose<double>> camera_T_links,
                                             const PixelOf& pixel_of) const {
  std::vector<Posed> all(links_.size());
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const Link& link = links_[l];
    for (const Vector3<double>& p : link.vertices) {
      all[l].pixels.push_back(pixel_of(camera_T_links[l] * p));
    }
    const Vector3<double> eye = camera_T_links[l].inverse().translation;
    for (std::size_t t = 0; t < link.triangles.size(); ++t) {
      const Vector3<double>& corner = link.vertices[link.triangles[t][0]];
      all[l].faces.push_back(link.normals[t].dot(eye - corner) > 0.0 ? 1 : 0);
    }
  }
  return all;
}

void Outliner::draw(const std::vector<Posed>& posed, detail::Raster& raster) const {
  for (std::size_t l = 0; l < links_.size(); ++l) {
    for (std::size_t t = 0; t < links_[l].triangles.size(); ++t) {
      if (links_[l].closed && posed[l].faces[t] == 0) continue;
      const detail::Corners& c = links_[l].triangles[t];
      const auto &p = posed[l].pixels[c[0]], &q = posed[l].pixels[c[1]], &r = posed[l].pixels[c[2]];
      if (p.allFinite() && q.allFinite() && r.allFinite()) raster.add(p, q, r);
    }
  }
}

GrayImage Outliner::mask(std::span<const Pose<double>> camera_T_links, const PixelOf& pixel_of,
                         int width, int height) const {
  detail::Raster raster(width, height);
  draw(posed(camera_T_links, pixel_of), raster);
  return raster.image();
}

std::vector<OutlinePoint> Outliner::outline(std::span<const Pose<double>> camera_T_links,
                                            const PixelOf& pixel_of, int width, int height) const {
  const std::vector<Posed> posed = this->posed(camera_T_links, pixel_of);
  detail::Raster raster(width, height);
  draw(posed, raster);
  std::vector<OutlinePoint> outline;
  GrayImage taken(width, height, 0);
  for (std::size_t l = 0; l < links_.size(); ++l) {
    const Link& link = links_[l];
    for (const Edge& edge : link.edges) {
      const bool is_end = edge.triangles[0] == edge.triangles[1];
      if (!is_end && posed[l].faces[edge.triangles[0]] == posed[l].faces[edge.triangles[1]]) {
        continue;
      }
      const Eigen::Vector2d &a = posed[l].pixels[edge.corners[0]],
                            &b = posed[l].pixels[edge.corners[1]];
      const double length = (b - a).norm();
      if (!(length > 0.0) || length > width + height) continue;
      Eigen::Vector2d normal(a.y() - b.y(), b.x() - a.x());
      normal /= length;
      const int count = std::max(1, static_cast<int>(std::ceil(length)));
      const auto distance = [&](const Vector3<double>& of) {
        return (camera_T_links[l] * of).norm();
      };
      for (int i = 0; i < count; ++i) {
        const double part = (i + 0.5) / count;
        const Eigen::Vector2d pixel = a + part * (b - a);
        if (!detail::is_inside(pixel, width, height)) continue;
        constexpr double kBeyond = 0.6;  // pixels
        const bool left = raster.at(pixel + kBeyond * normal),
                   right = raster.at(pixel - kBeyond * normal);
        if (left == right) continue;
        std::uint8_t& here = taken(static_cast<int>(std::lround(pixel.x())),
                                   static_cast<int>(std::lround(pixel.y())));
        if (here != 0) continue;
        here = 1;
        const Vector3<double>&p = link.vertices[edge.corners[0]],
              &q = link.vertices[edge.corners[1]];
        const double near = (1.0 - part) * distance(q), far = part * distance(p);
        const Vector3<double> point = p + far / (near + far) * (q - p);
        outline.push_back({pixel_of(camera_T_links[l] * point),
                           left ? Eigen::Vector2d(-normal) : normal, static_cast<int>(l), point});
      }
    }
  }
  return outline;
}

PixelGrid::PixelGrid(std::vector<Eigen::Vector2d> pixels, int width, int height)
    : columns_(1 + static_cast<int>(width / kCell)),
      rows_(1 + static_cast<int>(height / kCell)),
      pixels_(std::move(pixels)),
      first_(static_cast<std::size_t>(columns_ * rows_) + 1, 0),
      order_(pixels_.size()) {
  std::vector<std::size_t> cells;
  for (const Eigen::Vector2d& pixel : pixels_) {
    const int u = std::clamp(static_cast<int>(std::floor(pixel.x() / kCell)), 0, columns_ - 1),
              v = std::clamp(static_cast<int>(std::floor(pixel.y() / kCell)), 0, rows_ - 1);
    cells.push_back(static_cast<std::size_t>(v * columns_ + u));
    ++first_[cells.back() + 1];
  }
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    order_[static_cast<std::size_t>(next[cells[i]]++)] = static_cast<int>(i);
  }
}

}  // namespace kinecal
