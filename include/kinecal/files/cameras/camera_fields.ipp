// Common parts of camera file formats: matrices, sizes, checks and defaults.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/yaml/config_map.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Keys with the same meaning.
using CameraKeys = std::vector<std::string>;

/// The entry of one of several keys, or nullptr; two of them are an error.
[[nodiscard]] inline const ConfigEntry* find_camera_key(ConfigMap& map, const CameraKeys& keys) {
  const ConfigEntry* found = nullptr;
  for (const std::string& key : keys) {
    const ConfigEntry* entry = map.find(key);
    if (entry == nullptr) continue;
    if (found != nullptr) {
      map.error(entry->place, "'" + key + "' says the same as '" + found->key + "' in line " +
                                  std::to_string(found->place.line) + "; keep one of them");
    }
    found = entry;
  }
  return found;
}

/// "key has 8 numbers"
[[nodiscard]] inline std::string has_numbers(const std::string& key, std::size_t count) {
  return fmt::format("{} has {} number{}", key, count, count == 1 ? "" : "s");
}

/// Finite numbers: a list, or the `data` of a matrix {rows, cols, data}; anything else is an error
/// and gives nullopt.
[[nodiscard]] inline std::optional<std::vector<double>> camera_numbers(const ConfigMap& map,
                                                                       const ConfigEntry& entry) {
  const YamlNode* list = entry.value.is_map() ? entry.value.find("data") : &entry.value;
  if (list == nullptr || !list->is_list()) {
    map.error(entry.place, entry.key + " is neither a list of numbers nor a matrix with data");
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (const YamlNode& item : list->items) {
    const std::optional<double> number = config_number(item);
    if (!number || !std::isfinite(*number)) {
      map.error({entry.place.file, item.line},
                entry.key + ": " + describe_config(item) + " is not a finite number");
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  const YamlNode *rows = entry.value.find("rows"), *cols = entry.value.find("cols");
  if (rows == nullptr || cols == nullptr) return numbers;
  const double size = config_number(*rows).value_or(0.0) * config_number(*cols).value_or(0.0);
  if (size != static_cast<double>(numbers.size())) {
    map.error(entry.place, fmt::format("{}, not {} x {}", has_numbers(entry.key, numbers.size()),
                                       describe_config(*rows), describe_config(*cols)));
    return std::nullopt;
  }
  return numbers;
}

/// A matrix of N numbers; an error if it has another size.
/// @return  true if it is in the file
template <std::size_t N>
bool read_camera_matrix(ConfigMap& map, const CameraKeys& keys, std::array<double, N>& matrix) {
  const ConfigEntry* entry = find_camera_key(map, keys);
  if (entry == nullptr) return false;
  const auto numbers = camera_numbers(map, *entry);
  if (!numbers) return true;
  if (numbers->size() == N) {
    std::copy(numbers->begin(), numbers->end(), matrix.begin());
  } else {
    map.error(entry->place, fmt::format("{}, not {}", has_numbers(entry->key, numbers->size()), N));
  }
  return true;
}

/// A number of pixels; zero if the key is missing.
[[nodiscard]] inline int read_camera_size(ConfigMap& map, const CameraKeys& keys) {
  const ConfigEntry* entry = find_camera_key(map, keys);
  return entry == nullptr ? 0 : map.count(entry->key, 0);
}

/// Defaults R = 1 and P = [K 0]: pixels of an image rectified to the camera's own matrix.
inline void complete_camera(CameraInfo& camera, bool has_r, bool has_p, const SourceLocation& place,
                            Diagnostics& diagnostics) {
  const auto& k = camera.k;
  if (!has_r) camera.r = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  if (has_p) return;
  camera.p = {k[0], k[1], k[2], 0, k[3], k[4], k[5], 0, k[6], k[7], k[8], 0};
  const bool bends = std::any_of(camera.d.begin(), camera.d.end(), [](double v) { return v != 0; });
  if (!bends) return;
  diagnostics.warning(
      place,
      "there is no projection_matrix; camera_matrix is used instead, so rectified pixels must "
      "be of images that were rectified to it");
}

/// What a focal length below zero means.
inline constexpr const char* kMirrored =
    "; is the image mirrored, or are u and v of the pixels exchanged?";

/// Reports values impossible for a pinhole camera.  One of K and P may be all zero.
/// @param k_line  of K, from 1; 0 if unknown
inline void check_camera(const CameraInfo& camera, const SourceLocation& place,
                         Diagnostics& diagnostics, int k_line = 0) {
  const SourceLocation k_place{place.file, k_line > 0 ? k_line : place.line};
  const auto& k = camera.k;
  const auto& p = camera.p;
  const bool has_k = k[0] != 0.0 || k[4] != 0.0, has_p = p[0] != 0.0 || p[5] != 0.0;
  if (!has_k && has_p) {
    diagnostics.warning(place, "K is zero; P is used, so pixels must be of rectified images");
  } else if (!(k[0] > 0.0) || !(k[4] > 0.0)) {
    diagnostics.error(
        k_place, fmt::format("focal lengths {:.6g} and {:.6g} are not greater than zero{}", k[0],
                             k[4], k[0] * k[4] < 0.0 ? kMirrored : ""));
  } else if (k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    diagnostics.error(
        k_place,
        fmt::format("the last row of the camera matrix is {} {} {}, not 0 0 1", k[6], k[7], k[8]));
  }
  if (!has_p && has_k) {
    diagnostics.warning(place, "P is zero; K is used");
  } else if (has_p && (!(p[0] > 0.0) || !(p[5] > 0.0))) {
    diagnostics.error(
        place, fmt::format("focal lengths {:.6g} and {:.6g} of the projection are not greater "
                           "than zero{}",
                           p[0], p[5], p[0] * p[5] < 0.0 ? kMirrored : ""));
  }
  if (camera.width == 0 || camera.height == 0) {
    diagnostics.warning(place, "the size of the image is missing; ROS drivers need it");
  }
}

}  // namespace kinecal::detail
