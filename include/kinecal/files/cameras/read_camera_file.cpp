// Definitions of read_camera_file.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/read_camera_file.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "kinecal/files/cameras/camera_formats.ipp"
#include "kinecal/files/cameras/opencv_camera.ipp"
#include "kinecal/files/yaml/yaml_node.hpp"

namespace kinecal {

namespace detail {
namespace {

/// One of the cameras of a camchain, by name; without a name, the only one.
[[nodiscard]] CameraInfo read_camchain(const ConfigMap& file, const std::string& which) {
  std::vector<std::string> names;
  const ConfigEntry* chosen = nullptr;
  for (const ConfigEntry& entry : file.entries()) {
    if (!is_kalibr_camera(entry)) continue;
    names.push_back(entry.key);
    if (which.empty() || entry.key == which) chosen = &entry;
  }
  if (which.empty() && names.size() > 1) {
    file.error(file.place(), "there are several cameras, " + names.front() + " to " + names.back() +
                                 "; choose one: " + file.place().file + ":" + names.front());
    return {};
  }
  if (chosen == nullptr) {
    file.error(file.place(), "there is no camera '" + which + "'" + did_you_mean(which, names));
    return {};
  }
  auto camera = file.map(*chosen, chosen->key);
  return camera ? read_kalibr_camera(*camera) : CameraInfo{};
}

/// The map of a camera file; of several messages, the first.
[[nodiscard]] YamlNode camera_document(const std::string& path) {
  for (YamlNode& document : parse_yaml(without_opencv_header(read_yaml_text(path)), path)) {
    if (document.is_map()) return std::move(document);
    if (!document.is_null()) break;
  }
  throw InputError(path + ": is not a camera file: not a map of names and values");
}

}  // namespace
}  // namespace detail

CameraInfo read_camera_file(const std::string& path, Diagnostics& diagnostics,
                            const std::string& which) {
  const detail::YamlNode document = detail::camera_document(path);
  detail::ConfigMap file(document, {path, 0}, "", diagnostics);
  const std::size_t errors = diagnostics.errors.size();
  const auto any = [&](bool (*is)(const detail::ConfigEntry&)) {
    return std::any_of(file.entries().begin(), file.entries().end(), is);
  };
  CameraInfo camera;
  if (any(detail::is_kalibr_camera)) {
    camera = detail::read_camchain(file, which);
  } else if (!which.empty()) {
    file.error({path, 0},
               "has a single camera and there is no '" + which + "'; leave the name out");
  } else if (any(detail::is_opencv_matrix)) {
    camera = detail::read_opencv_camera(file);
  } else if (file.peek("camera_matrix") || file.peek("K") || file.peek("k")) {
    camera = detail::read_camera_info(file);
  } else {
    file.error({path, 0},
               "is not a camera file: it has neither camera_matrix (camera_info, OpenCV), nor K or "
               "k (a message), nor a camera_model below cam0 (Kalibr)");
  }
  if (diagnostics.errors.size() != errors) return camera;
  int k_line = 0;
  for (const char* key : {"camera_matrix", "K", "k"}) {
    if (const detail::ConfigEntry* k = file.peek(key)) k_line = k->place.line;
  }
  detail::check_camera(camera, {path, 0}, diagnostics, k_line);
  return camera;
}

CameraInfo read_camera_argument(const std::string& argument, Diagnostics& diagnostics) {
  const std::size_t colon = argument.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(argument)) {
    return read_camera_file(argument, diagnostics);
  }
  return read_camera_file(argument.substr(0, colon), diagnostics, argument.substr(colon + 1));
}

}  // namespace kinecal
