// Definitions of render.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/study/render.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

namespace kinecal {

namespace detail {
namespace {

// Patches in the camera's frame.

/// A range of directions x/z, y/z.
struct Window {
  double left = std::numeric_limits<double>::infinity(), right = -left;
  double top = left, bottom = -left;

  void include(const Vector3<double>& ray) {
    left = std::min(left, ray.x());
    right = std::max(right, ray.x());
    top = std::min(top, ray.y());
    bottom = std::max(bottom, ray.y());
  }
  [[nodiscard]] bool overlaps(const Window& other) const {
    return left <= other.right && other.left <= right && top <= other.bottom && other.top <= bottom;
  }
};

/// The intersection of a ray with a patch.
struct Meeting {
  double z = 0.0;           ///< distance along the optical axis, metres
  double x = 0.0, y = 0.0;  ///< in the patch, metres
};

/// Brightness of a surface that faces the camera; 255 is white in full light.
/// @param normal   (3) towards the camera, unit vector
/// @param to_lamp  (3) metres
[[nodiscard]] double lit(double albedo, const Vector3<double>& normal,
                         const Vector3<double>& to_lamp, const Light& light) {
  constexpr double kWhite = 255.0;
  const double distance = to_lamp.norm(), far = distance / light.reach;
  const double cosine = std::max(0.0, normal.dot(to_lamp) / distance);
  return kWhite * albedo * (light.ambient + light.lamp * cosine / (1.0 + far * far));
}

/// A patch in the frame of a camera.
struct Flat {
  const Patch* patch = nullptr;
  Pose<double> pose;     ///< camera_T_patch
  Vector3<double> lamp;  ///< in the camera, metres
  const Light* light = nullptr;
  double to_plane = 0.0, x0 = 0.0, y0 = 0.0;  ///< the camera's origin along the axes of the patch
  Window window;
  bool shines = false;

  /// True if it faces the camera.
  [[nodiscard]] bool is_front() const { return to_plane > 0.0; }

  /// @param ray  (3) direction (x, y, 1)
  [[nodiscard]] std::optional<Meeting> meet(const Vector3<double>& ray) const {
    constexpr double kNearest = 1e-3, kParallel = 1e-9;
    const double along = pose.rotation.col(2).dot(ray);
    if (std::abs(along) < kParallel) return std::nullopt;
    const double z = to_plane / along;
    if (!(z > kNearest)) return std::nullopt;
    const double x = z * pose.rotation.col(0).dot(ray) - x0;
    const double y = z * pose.rotation.col(1).dot(ray) - y0;
    const double right = 2.0 * x / patch->width, down = 2.0 * y / patch->height;
    const bool inside = patch->round ? right * right + down * down <= 1.0
                                     : std::abs(right) <= 1.0 && std::abs(down) <= 1.0;
    return inside ? std::optional(Meeting{z, x, y}) : std::nullopt;
  }

  /// Brightness at a place on it; 255 is white in full light.
  [[nodiscard]] double brightness(const Vector3<double>& ray, const Meeting& at) const {
    constexpr double kShining = 1000.0;
    if (shines && is_front()) return kShining;
    const double side = is_front() ? -1.0 : 1.0;
    return lit(albedo(at), side * pose.rotation.col(2), lamp - at.z * ray, *light);
  }

  /// Cosine between a ray and the normal.
  [[nodiscard]] double cosine(const Vector3<double>& ray) const {
    return std::abs(pose.rotation.col(2).dot(ray)) / ray.norm();
  }

 private:
  [[nodiscard]] double albedo(const Meeting& at) const {
    if (!patch->texture || !is_front()) return patch->albedo;
    const GrayImage& image = *patch->texture;
    const auto texel = [](double share, int size) {
      return std::clamp(static_cast<int>(share * size), 0, size - 1);
    };
    return image(texel(at.x / patch->width + 0.5, image.width),
                 texel(at.y / patch->height + 0.5, image.height)) /
           255.0;
  }
};

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr Window kEverywhere{-kInfinite, kInfinite, -kInfinite, kInfinite};

/// The directions in which the hull of corners is visible; all if a part of it is beside or behind the
/// camera, an empty window if it is entirely behind.
/// @param corners  (3) each, in the camera, metres
Window window_of(std::span<const Vector3<double>> corners) {
  Window window;
  constexpr double kNearest = 0.01;
  std::size_t behind = 0;
  for (const Vector3<double>& corner : corners) {
    if (corner.z() < kNearest) {
      ++behind;
    } else {
      window.include(corner / corner.z());
    }
  }
  if (behind == corners.size()) return {};
  return behind > 0 ? kEverywhere : window;
}

Window window_of(const Flat& flat) {
  if (!std::isfinite(flat.patch->width) || !std::isfinite(flat.patch->height)) return kEverywhere;
  const double x = 0.5 * flat.patch->width, y = 0.5 * flat.patch->height;
  const std::array corners = {
      flat.pose * Vector3<double>(-x, -y, 0.0), flat.pose * Vector3<double>(x, -y, 0.0),
      flat.pose * Vector3<double>(-x, y, 0.0), flat.pose * Vector3<double>(x, y, 0.0)};
  return window_of(corners);
}

/// A solid in the frame of a camera.
struct Body {
  const Solid* solid = nullptr;
  Pose<double> link_T_camera;
  Window window;

  /// @param ray  (3) direction (x, y, 1): the hit's distance is that along the optical axis; its normal is in the
  ///             camera, towards it
  [[nodiscard]] std::optional<SolidHit> meet(const Vector3<double>& ray) const {
    const Vector3<double> direction = link_T_camera.rotation * ray;
    auto hit = solid->cast(link_T_camera.translation, direction);
    if (!hit) return hit;
    const double side = hit->normal.dot(direction) > 0.0 ? -1.0 : 1.0;
    hit->normal = side * (link_T_camera.rotation.transpose() * hit->normal);
    return hit;
  }
};

/// The solids of a scene in the frame of a camera.
std::vector<Body> bodies_of(const Scene& scene, const PoseInCamera& pose_of) {
  std::vector<Body> bodies;
  for (const Solid& solid : scene.solids) {
    const Pose<double> camera_T_link = pose_of(solid.link);
    std::vector<Vector3<double>> corners;
    for (const double x : {solid.low.x(), solid.high.x()}) {
      for (const double y : {solid.low.y(), solid.high.y()}) {
        for (const double z : {solid.low.z(), solid.high.z()}) {
          corners.push_back(camera_T_link * Vector3<double>(x, y, z));
        }
      }
    }
    bodies.push_back({&solid, camera_T_link.inverse(), window_of(corners)});
  }
  return bodies;
}

/// The patches of a scene in the frame of a camera.
/// @param code  of the LEDs that are lit
std::vector<Flat> flats_of(const Scene& scene, const PoseInCamera& pose_of, int code) {
  const Vector3<double> lamp = pose_of("") * scene.light.position;
  std::vector<Flat> flats;
  std::string link;
  Pose<double> camera_T_link = pose_of("");
  for (const Patch& patch : scene.patches) {
    if (patch.link != link) {
      link = patch.link;
      camera_T_link = pose_of(link);
    }
    Flat flat;
    flat.patch = &patch;
    flat.pose = camera_T_link * patch.pose;
    flat.lamp = lamp;
    flat.light = &scene.light;
    flat.to_plane = flat.pose.rotation.col(2).dot(flat.pose.translation);
    flat.x0 = flat.pose.rotation.col(0).dot(flat.pose.translation);
    flat.y0 = flat.pose.rotation.col(1).dot(flat.pose.translation);
    flat.shines = patch.led != 0 && patch.led == code;
    flat.window = window_of(flat);
    flats.push_back(flat);
  }
  return flats;
}

// Casts rays through the pixels of an image.

/// The nearest point along a ray: on a patch or on a solid.
struct Hit {
  int flat = -1;
  int body = -1;
  Meeting at;
  Vector3<double> normal = Vector3<double>::Zero();  ///< (3) of a solid, towards the camera
};

/// A part of the image, and what may appear in it.
struct Tile {
  int left, top, right, bottom;  ///< pixels; right and bottom are excluded
  std::vector<int> flats, bodies;
};

/// One rendering.
class Casting {
 public:
  Casting(const Image<Vector3<double>>& corners, std::vector<Flat> flats, std::vector<Body> bodies,
          const Scene& scene, const Vector3<double>& lamp, double grazing, Picture& picture)
      : corners_(corners),
        flats_(std::move(flats)),
        bodies_(std::move(bodies)),
        light_(scene.light),
        lamp_(lamp),
        background_(255.0 * scene.background),
        grazing_(grazing),
        picture_(picture),
        seen_(picture.depth.width, picture.depth.height, -1) {}

  void run() {
    std::vector<Tile> tiles;
    for (int v = 0; v < seen_.height; v += kTile) {
      for (int u = 0; u < seen_.width; u += kTile) {
        tiles.push_back(tile_at(u, v));
        cast(tiles.back());
      }
    }
    const Image<float> centres = picture_.brightness;
    for (const Tile& tile : tiles) refine(tile, centres);
  }

 private:
  static constexpr int kTile = 16;  // pixels

  [[nodiscard]] Tile tile_at(int u, int v) const {
    Tile tile{u, v, std::min(u + kTile, seen_.width), std::min(v + kTile, seen_.height), {}, {}};
    Window window;
    for (int y = tile.top; y <= tile.bottom; ++y) {
      for (int x = tile.left; x <= tile.right; ++x) window.include(corners_(x, y));
    }
    for (std::size_t i = 0; i < flats_.size(); ++i) {
      if (flats_[i].window.overlaps(window)) tile.flats.push_back(static_cast<int>(i));
    }
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i].window.overlaps(window)) tile.bodies.push_back(static_cast<int>(i));
    }
    return tile;
  }

  /// The nearest surface; a patch mounted on another, like an LED on its body, hides it.
  [[nodiscard]] Hit nearest(const Tile& tile, const Vector3<double>& ray) const {
    constexpr double kOnTop = 1e-4;  // metres
    Hit hit;
    for (const int i : tile.flats) {
      const auto at = flats_[static_cast<std::size_t>(i)].meet(ray);
      if (at && (hit.flat < 0 || at->z < hit.at.z + kOnTop)) hit = {i, -1, *at};
    }
    for (const int i : tile.bodies) {
      const auto at = bodies_[static_cast<std::size_t>(i)].meet(ray);
      if (!at || (number_of(hit) >= 0 && hit.at.z <= at->distance)) continue;
      hit = {-1, i, {at->distance, 0.0, 0.0}, at->normal};
    }
    return hit;
  }

  /// Number of what is seen: patches, then solids; negative: nothing.
  [[nodiscard]] int number_of(const Hit& hit) const {
    return hit.body < 0 ? hit.flat : static_cast<int>(flats_.size()) + hit.body;
  }

  [[nodiscard]] double brightness(const Hit& hit, const Vector3<double>& ray) const {
    if (hit.body >= 0) {
      const Solid& solid = *bodies_[static_cast<std::size_t>(hit.body)].solid;
      return lit(solid.albedo, hit.normal, lamp_ - hit.at.z * ray, light_);
    }
    if (hit.flat < 0) return background_;
    return flats_[static_cast<std::size_t>(hit.flat)].brightness(ray, hit.at);
  }

  void cast(const Tile& tile) {
    for (int v = tile.top; v < tile.bottom; ++v) {
      for (int u = tile.left; u < tile.right; ++u) {
        const Vector3<double> ray = 0.25 * (corners_(u, v) + corners_(u + 1, v) +
                                            corners_(u, v + 1) + corners_(u + 1, v + 1));
        const Hit hit = nearest(tile, ray);
        picture_.brightness(u, v) = static_cast<float>(brightness(hit, ray));
        seen_(u, v) = number_of(hit);
        if (seen_(u, v) < 0) continue;
        picture_.depth(u, v) = static_cast<float>(hit.at.z);
        picture_.answer(u, v) = measures_depth(hit, ray) ? 1 : 0;
      }
    }
  }

  [[nodiscard]] bool measures_depth(const Hit& hit, const Vector3<double>& ray) const {
    if (hit.body >= 0) return -hit.normal.dot(ray) / ray.norm() > grazing_;
    const Flat& flat = flats_[static_cast<std::size_t>(hit.flat)];
    return !flat.shines && flat.cosine(ray) > grazing_;
  }

  /// True if a pixel shows more than one brightness; the triangles of a solid count as one.
  [[nodiscard]] bool is_mixed(const Image<float>& centres, int u, int v) const {
    constexpr float kStep = 3.0F;  // of 255: more than light that fades
    for (int y = std::max(0, v - 1); y <= std::min(v + 1, seen_.height - 1); ++y) {
      for (int x = std::max(0, u - 1); x <= std::min(u + 1, seen_.width - 1); ++x) {
        if (seen_(x, y) != seen_(u, v)) return true;
        if (seen_(u, v) >= static_cast<int>(flats_.size())) continue;
        if (std::abs(centres(x, y) - centres(u, v)) > kStep) return true;
      }
    }
    return false;
  }

  /// True if a pixel may show a patch so small that rays through pixel centres miss it.
  [[nodiscard]] bool has_small(const std::vector<const Flat*>& small, int u, int v) const {
    Window pixel;
    pixel.include(corners_(u, v));
    pixel.include(corners_(u + 1, v + 1));
    return std::any_of(small.begin(), small.end(),
                       [&](const Flat* flat) { return flat->window.overlaps(pixel); });
  }

  void refine(const Tile& tile, const Image<float>& centres) {
    constexpr double kSmall = 4.0;  // pixels
    const double pixel = corners_(tile.left + 1, tile.top).x() - corners_(tile.left, tile.top).x();
    std::vector<const Flat*> small;
    for (const int i : tile.flats) {
      const Flat& flat = flats_[static_cast<std::size_t>(i)];
      const Window& w = flat.window;
      if (std::min(w.right - w.left, w.bottom - w.top) < kSmall * pixel) small.push_back(&flat);
    }
    for (int v = tile.top; v < tile.bottom; ++v) {
      for (int u = tile.left; u < tile.right; ++u) {
        if (!is_mixed(centres, u, v) && !has_small(small, u, v)) continue;
        picture_.brightness(u, v) = static_cast<float>(mean(tile, u, v));
      }
    }
  }

  /// Mean brightness of a pixel's area.
  [[nodiscard]] double mean(const Tile& tile, int u, int v) const {
    const Vector3<double>&a = corners_(u, v), &b = corners_(u + 1, v), &c = corners_(u, v + 1);
    const Vector3<double> right = b - a, down = c - a, twist = corners_(u + 1, v + 1) - b - down;
    double sum = 0.0;
    for (const auto& [x, y] : lattice()) {
      const Vector3<double> ray = a + x * right + y * down + (x * y) * twist;
      sum += brightness(nearest(tile, ray), ray);
    }
    return sum / static_cast<double>(lattice().size());
  }

  /// Places in a pixel, no two in the same column or row.
  /// Source: the lattice of the golden ratio, which spreads evenly for any number of points.
  static const std::array<std::array<double, 2>, 128>& lattice() {
    static const auto places = [] {
      constexpr double kGolden = 0.6180339887498949;
      std::array<std::array<double, 2>, 128> all;
      for (std::size_t i = 0; i < all.size(); ++i) {
        const double n = static_cast<double>(i) + 0.5;
        all[i] = {n / static_cast<double>(all.size()), std::fmod(n * kGolden, 1.0)};
      }
      return all;
    }();
    return places;
  }

  const Image<Vector3<double>>& corners_;
  std::vector<Flat> flats_;
  std::vector<Body> bodies_;
  const Light& light_;
  Vector3<double> lamp_;  ///< in the camera, metres
  double background_, grazing_;
  Picture& picture_;
  Image<int> seen_;
};

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
bool is_visible(const std::vector<Flat>& flats, const std::vector<Body>& bodies, const Flat& led) {
  const Vector3<double>& centre = led.pose.translation;
  constexpr double kNearest = 0.01, kOnTop = 1e-4;  // metres
  if (!led.is_front() || centre.z() < kNearest) return false;
  const Vector3<double> ray = centre / centre.z();
  const double before = centre.z() - kOnTop;
  const auto hides = [&](const Flat& flat) {
    const auto at = flat.meet(ray);
    return at && at->z < before;
  };
  const auto covers = [&](const Body& body) {
    const auto at = body.meet(ray);
    return at && at->distance < before;
  };
  return std::none_of(flats.begin(), flats.end(), hides) &&
         std::none_of(bodies.begin(), bodies.end(), covers);
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
  const std::vector<detail::Body> bodies = detail::bodies_of(scene, pose_of);
  detail::Casting(corners_, flats, bodies, scene, pose_of("") * scene.light.position, grazing_,
                  picture)
      .run();
  for (const detail::Flat& flat : flats) {
    if (flat.shines && detail::is_visible(flats, bodies, flat))
      detail::add_glow(lens_, flat, picture);
  }
  return picture;
}

}  // namespace kinecal
