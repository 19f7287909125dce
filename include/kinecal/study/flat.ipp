// Patches in the camera's frame, for render.cpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "kinecal/study/render.hpp"

namespace kinecal::detail {

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
    constexpr double kWhite = 255.0, kShining = 1000.0;
    if (shines && is_front()) return kShining;
    const Vector3<double> to_lamp = lamp - at.z * ray;
    const double distance = to_lamp.norm(), side = is_front() ? -1.0 : 1.0;
    const double cosine = std::max(0.0, side * pose.rotation.col(2).dot(to_lamp) / distance);
    const double far = distance / light->reach;
    return kWhite * albedo(at) * (light->ambient + light->lamp * cosine / (1.0 + far * far));
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

/// The directions in which a patch is visible; all if a part of it is beside or behind the camera,
/// none if it is entirely behind.
inline Window window_of(const Flat& flat) {
  Window window;
  constexpr double kNearest = 0.01, kInfinite = std::numeric_limits<double>::infinity();
  const Window everywhere{-kInfinite, kInfinite, -kInfinite, kInfinite};
  if (!std::isfinite(flat.patch->width) || !std::isfinite(flat.patch->height)) return everywhere;
  int behind = 0;
  for (const double right : {-0.5, 0.5}) {
    for (const double down : {-0.5, 0.5}) {
      const Vector3<double> corner =
          flat.pose * Vector3<double>(right * flat.patch->width, down * flat.patch->height, 0.0);
      if (corner.z() < kNearest) {
        ++behind;
      } else {
        window.include(corner / corner.z());
      }
    }
  }
  if (behind == 4) return {};
  return behind > 0 ? everywhere : window;
}

/// The patches of a scene in the frame of a camera.
/// @param code  of the LEDs that are lit
inline std::vector<Flat> flats_of(const Scene& scene, const PoseInCamera& pose_of, int code) {
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

}  // namespace kinecal::detail
