// The formats of camera files.
//
// camera_info   image_width, image_height, camera_name, distortion_model, and matrices
//               {rows, cols, data}: camera_matrix, distortion_coefficients, rectification_matrix,
//               projection_matrix.  The message: width, height, distortion_model and the lists
//               K D R P (ROS 1) or k d r p (ROS 2).
//               Source: ROS wiki, camera_calibration_parsers; sensor_msgs/CameraInfo.
// Kalibr        A map of cameras, cam0, cam1 and so on: camera_model: pinhole,
//               intrinsics: [fu, fv, pu, pv], distortion_model: radtan, equidistant or none,
//               distortion_coeffs: [k1, k2, p1, p2] or [k1, k2, k3, k4], resolution: [width, height].
//               radtan is plumb_bob with k3 = 0.  Or camera_model: ds, the double sphere, with
//               intrinsics: [xi, alpha, fu, fv, pu, pv] and no distortion.
//               Source: Kalibr wiki, YAML formats and supported models.
// OpenCV        %YAML:1.0, image_width, image_height, and !!opencv-matrix {rows, cols, dt, data}:
//               camera_matrix, distortion_coefficients.  Case and underscores of keys vary, and so does
//               the name of the distortion: see distortion_keys.ipp.  Four coefficients are plumb_bob
//               with k3 = 0, five plumb_bob, eight, twelve or fourteen rational_polynomial; with
//               fisheye_model: 1, four are equidistant.
//               Source: OpenCV documentation, FileStorage; calib3d, distortion coefficients.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/cameras/camera_fields.ipp"
#include "kinecal/files/cameras/distortion_keys.ipp"
#include "kinecal/files/cameras/image_part.ipp"
#include "kinecal/sensors/lens_camera.hpp"

namespace kinecal::detail {

/// Warns if a camera_info describes only a part of the image.
inline void doubt_image_part(ConfigMap& file, const CameraInfo& camera) {
  ImagePart part{file.number("binning_x", 0.0), file.number("binning_y", 0.0)};
  if (const ConfigEntry* entry = file.find("roi"); entry != nullptr && entry->value.is_map()) {
    ConfigMap roi(entry->value, entry->place, "roi", file.diagnostics());
    part.x = roi.number("x_offset", 0.0), part.y = roi.number("y_offset", 0.0);
    part.width = roi.number("width", 0.0), part.height = roi.number("height", 0.0);
  }
  const std::string doubt = doubt_image_part(part, camera);
  if (!doubt.empty()) file.diagnostics().warning(file.place(), doubt);
}

/// Warns of a camera without distortion; rejects one with the distortion under another key.
/// @param known  keys that were read
inline void doubt_no_distortion(ConfigMap& file, const CameraKeys& known,
                                const std::string& intended, bool any_name) {
  if (refuse_lost_distortion(file, known, intended, any_name)) return;
  file.warning(file.place(),
               "there is no " + intended + "; the lens is taken to be free of distortion");
}

/// Reads a camera_info file or message.
/// @param file  the top-level map
[[nodiscard]] inline CameraInfo read_camera_info(ConfigMap& file) {
  CameraInfo camera;
  camera.width = read_camera_size(file, {"image_width", "width"});
  camera.height = read_camera_size(file, {"image_height", "height"});
  const ConfigEntry* model = file.find("distortion_model");
  const bool is_empty = model != nullptr && model->value.is_scalar() && model->value.text.empty();
  if (!is_empty) camera.distortion_model = file.text("distortion_model").value_or("plumb_bob");
  if (const ConfigEntry* d = find_camera_key(file, {"distortion_coefficients", "D", "d"})) {
    camera.d = camera_numbers(file, *d).value_or(std::vector<double>());
  } else if (!is_empty) {
    const std::string intended = file.peek("K")   ? "D"
                                 : file.peek("k") ? "d"
                                                  : "distortion_coefficients";
    doubt_no_distortion(file, {"distortion_model"}, intended, false);
  }
  if (!read_camera_matrix(file, {"camera_matrix", "K", "k"}, camera.k)) {
    file.error(file.place(), "camera_matrix is missing");
  }
  const bool has_r = read_camera_matrix(file, {"rectification_matrix", "R", "r"}, camera.r);
  const bool has_p = read_camera_matrix(file, {"projection_matrix", "P", "p"}, camera.p);
  doubt_image_part(file, camera);
  file.ignore({"camera_name", "header"});
  ignore_beside_camera(file);
  file.report_unknown();  // or camera_matrix would replace a misspelt projection_matrix
  complete_camera(camera, has_r, has_p, file.place(), file.diagnostics());
  return camera;
}

/// True for a camera of Kalibr's camchain: a map with a camera model.
[[nodiscard]] inline bool is_kalibr_camera(const ConfigEntry& entry) {
  return entry.value.find("camera_model") != nullptr;
}

/// `count` numbers; zeros, and an error, if they are missing or their number differs.
[[nodiscard]] inline std::vector<double> kalibr_numbers(ConfigMap& camera, const std::string& key,
                                                        std::size_t count) {
  const ConfigEntry* entry = camera.find(key);
  if (entry == nullptr) {
    const CameraKeys wanted = {key};
    for (const ConfigEntry& other : camera.entries()) {
      if (camera.is_used(other.key) || meant_by_key(other.key, wanted).empty()) continue;
      camera.error(other.place,
                   "unknown key '" + other.key + "'" + meant_by_key(other.key, wanted));
      (void)camera.use(other.key);
      return std::vector<double>(count, 0.0);
    }
    camera.error(camera.place(), key + " is missing");
    return std::vector<double>(count, 0.0);
  }
  auto numbers = camera_numbers(camera, *entry);
  if (!numbers) return std::vector<double>(count, 0.0);
  if (numbers->size() != count) {
    camera.error(entry->place, fmt::format("{}, not {}", has_numbers(key, numbers->size()), count));
    numbers->resize(count);
  }
  return *numbers;
}

/// Reports any other than the expected models.
/// @return  the model
[[nodiscard]] inline std::string expect_kalibr_model(ConfigMap& camera, const std::string& key,
                                                     const std::vector<std::string>& expected) {
  const std::string model = camera.required_text(key).value_or("");
  if (!model.empty() && std::find(expected.begin(), expected.end(), model) == expected.end()) {
    camera.error(camera.find(key)->place, fmt::format("{} '{}' is not supported; it must be {}",
                                                      key, model, fmt::join(expected, " or ")));
  }
  return model;
}

/// Reads one camera of Kalibr's camchain.
/// @param camera  its map
[[nodiscard]] inline CameraInfo read_kalibr_camera(ConfigMap& camera) {
  const std::size_t errors = camera.diagnostics().errors.size();
  const bool is_sphere = expect_kalibr_model(camera, "camera_model", {"pinhole", "ds"}) == "ds";
  const std::string distortion =
      is_sphere
          ? expect_kalibr_model(camera, "distortion_model", {"none"})
          : expect_kalibr_model(camera, "distortion_model", {"radtan", "equidistant", "none"});
  CameraInfo info;
  if (camera.diagnostics().errors.size() > errors) return info;  // numbers of another model
  std::vector<double> f = kalibr_numbers(camera, "intrinsics", is_sphere ? 6 : 4);
  info.d = kalibr_numbers(camera, "distortion_coeffs", distortion == "none" ? 0 : 4);
  info.distortion_model = "plumb_bob";
  if (is_sphere) {
    info.distortion_model = DoubleSphere::kName;
    info.d.assign(f.begin(), f.begin() + 2);
    f.erase(f.begin(), f.begin() + 2);
  } else if (distortion == "equidistant") {
    info.distortion_model = Equidistant::kName;
  } else {
    info.d.resize(5, 0.0);
  }
  info.k = {f[0], 0, f[2], 0, f[1], f[3], 0, 0, 1};
  const std::vector<double> size = kalibr_numbers(camera, "resolution", 2);
  for (const double pixels : size) {
    if (pixels >= 0.0 && pixels <= 1e6 && pixels == std::floor(pixels)) continue;
    camera.error(camera.place(), fmt::format("resolution: {} is not a number of pixels", pixels));
    return info;
  }
  camera.ignore({"rostopic", "T_cn_cnm1", "T_cam_imu", "T_imu_cam", "timeshift_cam_imu",
                 "cam_overlaps", "line_delay"});
  ignore_beside_camera(camera);
  camera.report_unknown();
  info.width = static_cast<int>(size[0]);
  info.height = static_cast<int>(size[1]);
  complete_camera(info, false, false, camera.place(), camera.diagnostics());
  return info;
}

}  // namespace kinecal::detail
