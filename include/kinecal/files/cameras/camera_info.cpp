// Definitions of camera_info.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/cameras/camera_info.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal {

namespace detail {
namespace {

[[nodiscard]] std::string matrix_to_yaml(std::string_view name, std::size_t rows,
                                         std::span<const double> row_major) {
  return fmt::format("{}:\n  rows: {}\n  cols: {}\n  data: {}\n", name, rows,
                     row_major.size() / rows, numbers_to_yaml(row_major));
}

/// The coefficients of a lens with at most `count` that are not zero.
/// @throws std::invalid_argument  if there are more
[[nodiscard]] std::vector<double> coefficients_within(const CameraInfo& camera, std::size_t count,
                                                      const char* format) {
  std::vector<double> d = camera.d;
  while (d.size() > count && d.back() == 0.0) d.pop_back();
  if (d.size() > count) {
    throw std::invalid_argument(fmt::format("{} has no lens {} with {} distortion coefficients",
                                            format, lens_of(camera), d.size()));
  }
  d.resize(count, 0.0);
  return d;
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

std::string to_kalibr_yaml(const CameraInfo& camera, const std::string& camera_name) {
  const std::string lens = lens_of(camera);
  const auto& k = camera.k;
  std::vector<double> intrinsics = {k[0], k[4], k[2], k[5]}, d;
  const char *model = "pinhole", *distortion = "radtan";
  if (lens == DoubleSphere::kName) {
    const std::vector<double> sphere = detail::coefficients_within(camera, 2, "Kalibr");
    intrinsics.insert(intrinsics.begin(), sphere.begin(), sphere.end());
    model = "ds";
    distortion = "none";
  } else {
    d = detail::coefficients_within(camera, 4, "Kalibr");
    if (lens == Equidistant::kName) distortion = "equidistant";
  }
  return fmt::format(
      "{}:\n  camera_model: {}\n  intrinsics: {}\n  distortion_model: {}\n  distortion_coeffs: {}\n"
      "  resolution: [{}, {}]\n",
      detail::name_to_yaml(camera_name), model, detail::numbers_to_yaml(intrinsics), distortion,
      detail::numbers_to_yaml(d), camera.width, camera.height);
}

std::string to_opencv_yaml(const CameraInfo& camera) {
  const std::string lens = lens_of(camera);
  if (lens == DoubleSphere::kName) {
    throw std::invalid_argument("OpenCV has no lens double_sphere");
  }
  const auto matrix = [](const char* name, std::size_t rows, std::span<const double> numbers) {
    return fmt::format("{}: !!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: {}\n",
                       name, rows, numbers.size() / rows, detail::numbers_to_yaml(numbers));
  };
  return fmt::format("%YAML:1.0\n---\nimage_width: {}\nimage_height: {}\n", camera.width,
                     camera.height) +
         (lens == Equidistant::kName ? "fisheye_model: 1\n" : "") +
         matrix("camera_matrix", 3, camera.k) + matrix("distortion_coefficients", 1, camera.d);
}

std::string to_camera_message_yaml(const CameraInfo& camera) {
  return fmt::format("height: {}\nwidth: {}\ndistortion_model: {}\nd: {}\nk: {}\nr: {}\np: {}\n",
                     camera.height, camera.width, detail::name_to_yaml(camera.distortion_model),
                     detail::numbers_to_yaml(camera.d), detail::numbers_to_yaml(camera.k),
                     detail::numbers_to_yaml(camera.r), detail::numbers_to_yaml(camera.p));
}

}  // namespace kinecal
