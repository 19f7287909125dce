// Intrinsics of a camera from a file, whoever wrote it: a camera_info file or message, Kalibr's
// camchain, OpenCV's FileStorage.  Which one it is shows in its content.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "kinecal/io/cameras/camera_info_file.hpp"
#include "kinecal/io/cameras/kalibr_file.hpp"
#include "kinecal/io/cameras/opencv_file.hpp"
#include "kinecal/io/text_file.hpp"
#include "kinecal/io/yaml/yaml_documents.hpp"

namespace kinecal {

namespace detail {

/// One of the cameras of a camchain, by name; the only one without.
[[nodiscard]] inline CameraInfo read_camchain(const ConfigMap& file, const std::string& which) {
  std::vector<std::string> names;
  const ConfigEntry* chosen = nullptr;
  for (const ConfigEntry& entry : file.entries()) {
    if (!is_kalibr_camera(entry)) continue;
    names.push_back(entry.key);
    if (which.empty() || entry.key == which) chosen = &entry;
  }
  if (which.empty() && names.size() > 1) {
    file.error(file.place(), "there are several cameras, " + names.front() + " to " + names.back() +
                                 "; say which: " + file.place().file + ":" + names.front());
    return {};
  }
  if (chosen == nullptr) {
    file.error(file.place(), "there is no camera '" + which + "'" + did_you_mean(which, names));
    return {};
  }
  auto camera = file.map(*chosen, chosen->key);
  return camera ? read_kalibr_camera(*camera) : CameraInfo{};
}

/// The map that a camera file is; of several messages the first.
[[nodiscard]] inline YAML::Node camera_document(const std::string& text, const std::string& path) {
  try {
    for (const YAML::Node& document : load_yaml_documents(without_opencv_header(text))) {
      if (document.IsMap()) return document;
      if (!document.IsNull()) break;
    }
  } catch (const YAML::Exception& error) {
    throw InputError(Place{path, error.mark.line + 1}.str() + ": " + error.msg);
  }
  throw InputError(path + ": is no camera file: not a map of names and values");
}

}  // namespace detail

/// Reads a camera.
/// @param path         a YAML file
/// @param diagnostics  is added errors and warnings, each with "file:line: "
/// @param which        of several cameras in one file: cam1
/// @return             incomplete if there are errors; z_offset 0 and z_scaling 1
/// @throws InputError  if the file cannot be read or is not YAML
[[nodiscard]] inline CameraInfo read_camera_file(const std::string& path, Diagnostics& diagnostics,
                                                 const std::string& which = {}) {
  ConfigMap file(detail::camera_document(read_text_file(path), path), {path, 0}, "", diagnostics);
  const std::size_t errors = diagnostics.errors.size();
  const auto any = [&](bool (*is)(const ConfigEntry&)) {
    return std::any_of(file.entries().begin(), file.entries().end(), is);
  };
  CameraInfo camera;
  if (any(is_kalibr_camera)) {
    camera = detail::read_camchain(file, which);
  } else if (!which.empty()) {
    file.error({path, 0}, "has one camera, and no '" + which + "'");
  } else if (any(is_opencv_matrix)) {
    camera = read_opencv_camera(file);
  } else if (file.peek("camera_matrix") || file.peek("K") || file.peek("k")) {
    camera = read_camera_info(file);
  } else {
    file.error({path, 0},
               "is no camera file: neither camera_matrix (camera_info, OpenCV), nor K or "
               "k (a message), nor a camera_model below cam0 (Kalibr)");
  }
  if (diagnostics.errors.size() == errors) detail::check_camera(camera, {path, 0}, diagnostics);
  return camera;
}

/// "file.yaml:cam1" as a file and a camera in it; a colon in the name of a file that is there is
/// none.
[[nodiscard]] inline CameraInfo read_camera_argument(const std::string& argument,
                                                     Diagnostics& diagnostics) {
  const std::size_t colon = argument.rfind(':');
  if (colon == std::string::npos || std::filesystem::exists(argument)) {
    return read_camera_file(argument, diagnostics);
  }
  return read_camera_file(argument.substr(0, colon), diagnostics, argument.substr(colon + 1));
}

}  // namespace kinecal
