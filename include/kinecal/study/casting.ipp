// Casts rays through the pixels of an image, for render.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "kinecal/study/flat.ipp"

namespace kinecal::detail {

/// The nearest point along a ray.
struct Hit {
  int flat = -1;
  Meeting at;
};

/// A part of the image, and the patches that may appear in it.
struct Tile {
  int left, top, right, bottom;  ///< pixels; right and bottom are excluded
  std::vector<int> flats;
};

/// One rendering.
class Casting {
 public:
  Casting(const Image<Vector3<double>>& corners, std::vector<Flat> flats, const Scene& scene,
          double grazing, Picture& picture)
      : corners_(corners),
        flats_(std::move(flats)),
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
    Tile tile{u, v, std::min(u + kTile, seen_.width), std::min(v + kTile, seen_.height), {}};
    Window window;
    for (int y = tile.top; y <= tile.bottom; ++y) {
      for (int x = tile.left; x <= tile.right; ++x) window.include(corners_(x, y));
    }
    for (std::size_t i = 0; i < flats_.size(); ++i) {
      if (flats_[i].window.overlaps(window)) tile.flats.push_back(static_cast<int>(i));
    }
    return tile;
  }

  /// The nearest patch; one mounted on another, like an LED on its body, hides it.
  [[nodiscard]] Hit nearest(const Tile& tile, const Vector3<double>& ray) const {
    constexpr double kOnTop = 1e-4;  // metres
    Hit hit;
    for (const int i : tile.flats) {
      const auto at = flats_[static_cast<std::size_t>(i)].meet(ray);
      if (at && (hit.flat < 0 || at->z < hit.at.z + kOnTop)) hit = {i, *at};
    }
    return hit;
  }

  [[nodiscard]] double brightness(const Hit& hit, const Vector3<double>& ray) const {
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
        seen_(u, v) = hit.flat;
        if (hit.flat < 0) continue;
        const Flat& flat = flats_[static_cast<std::size_t>(hit.flat)];
        picture_.depth(u, v) = static_cast<float>(hit.at.z);
        picture_.answer(u, v) = !flat.shines && flat.cosine(ray) > grazing_ ? 1 : 0;
      }
    }
  }

  /// True if a pixel shows more than one brightness.
  [[nodiscard]] bool is_mixed(const Image<float>& centres, int u, int v) const {
    constexpr float kStep = 3.0F;  // of 255: more than light that fades
    for (int y = std::max(0, v - 1); y <= std::min(v + 1, seen_.height - 1); ++y) {
      for (int x = std::max(0, u - 1); x <= std::min(u + 1, seen_.width - 1); ++x) {
        if (seen_(x, y) != seen_(u, v)) return true;
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
  double background_, grazing_;
  Picture& picture_;
  Image<int> seen_;
};

}  // namespace kinecal::detail
