// Definitions of camera_info.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/camera_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string_view>

#include "kinecal/files/yaml/yaml_text.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] std::string matrix_to_yaml(std::string_view name, std::size_t rows,
                                         std::span<const double> row_major) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows,
                     row_major.size() / rows, numbers_to_yaml(row_major));
}

}  // namespace
}  // namespace detail

bool is_blank(const CameraInfo& camera) {
  const auto zero = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
  };
  return camera.width == 0 && camera.height == 0 && camera.distortion_model.empty() &&
         zero(camera.d) && zero(camera.k) && zero(camera.r) && zero(camera.p);
}

std::string to_camera_info_yaml(const CameraInfo& camera, const std::string& camera_name) {
  std::string text = fmt::format("image_width: {}\nimage_height: {}\ncamera_name: {}\n",
                                 camera.width, camera.height, detail::name_to_yaml(camera_name));
  text += detail::matrix_to_yaml("camera_matrix", 3, camera.k);
  text += fmt::format("distortion_model: {}\n", detail::name_to_yaml(camera.distortion_model));
  text += detail::matrix_to_yaml("distortion_coefficients", 1, camera.d);
  text += detail::matrix_to_yaml("rectification_matrix", 3, camera.r);
  return text + detail::matrix_to_yaml("projection_matrix", 3, camera.p);
}

std::string to_camera_message_yaml(const CameraInfo& camera) {
  return fmt::format("height: {}\nwidth: {}\ndistortion_model: {}\nd: {}\nk: {}\nr: {}\np: {}\n",
                     camera.height, camera.width, detail::name_to_yaml(camera.distortion_model),
                     detail::numbers_to_yaml(camera.d), detail::numbers_to_yaml(camera.k),
                     detail::numbers_to_yaml(camera.r), detail::numbers_to_yaml(camera.p));
}

}  // namespace kinecal
