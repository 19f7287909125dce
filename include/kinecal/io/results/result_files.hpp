// The files that a calibration gives back: the robot, its cameras, the values.
//
//   calibrated.urdf        the URDF, patched in place
//   depth_<camera>.yaml    camera_info of each depth camera, and
//   rgb_<camera>.yaml      of each colour camera
//   calibration.yaml       name: value lines, then the files above; as installers read it
//
// With upstream's names: calibrated_<date>.urdf, depth_[<camera>_]<date>.yaml and so on, where the
// name of a camera called "camera" is left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/io/camera_info.hpp"
#include "kinecal/io/cameras/camera_fields.hpp"
#include "kinecal/io/results/file_set.hpp"
#include "kinecal/io/urdf/patch_urdf.hpp"
#include "kinecal/io/yaml/yaml_text.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

struct ResultFileOptions {
  OffsetStyle offsets = OffsetStyle::rising;
  std::string date = {};  ///< Y_m_d_H_M_S for upstream's names; empty: kinecal's names
};

/// What the parameters' values mean for each joint of the robot; virtual frames are in no URDF.
[[nodiscard]] inline std::vector<JointPatch> joint_patches(const Robot& robot,
                                                           const ParameterTable& table) {
  std::vector<JointPatch> patches;
  for (const Joint& joint : robot.joints()) {
    const auto value = [&](const std::string& name) {
      const int index = table.find(name);
      return index < 0 ? 0.0 : table[index].value;
    };
    Eigen::Matrix<double, 6, 1> frame;
    for (std::size_t axis = 0; axis < 6; ++axis) {
      frame(static_cast<Eigen::Index>(axis)) = value(parameter_name(joint.name, kFrameAxes[axis]));
    }
    JointPatch patch{joint.name, moves(joint.type) && !joint.mimic ? value(joint.name) : 0.0, {}};
    if (frame.isZero(0.0) && patch.offset == 0.0) continue;
    patch.correction = {exp(Vector3<double>(frame.tail<3>())), frame.head<3>()};
    patches.push_back(patch);
  }
  return patches;
}

/// The cameras of a calibration with their parameters applied to what was recorded.
struct CalibratedCamera {
  Sensor sensor;
  CameraInfo info;
};

[[nodiscard]] inline std::vector<CalibratedCamera> calibrated_cameras(
    const Calibration& calibration, const ParameterTable& table, std::span<const Sample> samples) {
  std::vector<CalibratedCamera> cameras;
  for (const CalibrationStep& step : calibration.steps) {
    for (const SensorModel& model : step.problem.sensors()) {
      const Sensor& sensor = model.sensor();
      if (sensor.type == SensorType::chain3d) continue;
      const auto same = [&](const auto& camera) { return camera.sensor.name == sensor.name; };
      if (std::any_of(cameras.begin(), cameras.end(), same)) continue;
      const auto value = [&](std::size_t i) {
        return table[parameter_name(sensor.parameter_prefix(), kCameraParameters[i])].value;
      };
      for (const Sample& sample : samples) {
        const Observation* seen = sample.observation(sensor.name);
        if (seen == nullptr || !seen->camera) continue;
        cameras.push_back({sensor, calibrated_camera_info(*seen->camera, value(0), value(1),
                                                          value(2), value(3))});
        break;
      }
    }
  }
  return cameras;
}

/// Why there is no camera such as was found, as one bad capture far away may make it; empty if all
/// are possible.
[[nodiscard]] inline std::string impossible_camera(const Calibration& calibration,
                                                   const ParameterTable& table,
                                                   std::span<const Sample> samples) {
  Diagnostics diagnostics;
  for (const CalibratedCamera& camera : calibrated_cameras(calibration, table, samples)) {
    const Place place{"camera '" + camera.sensor.name + "'", 0};
    detail::check_camera(camera.info, place, diagnostics);
    const std::string scaling = parameter_name(camera.sensor.parameter_prefix(), "z_scaling");
    if (camera.sensor.type == SensorType::camera3d && !(table[scaling].value > -1.0)) {
      diagnostics.error(place, fmt::format("depths times {}", 1.0 + table[scaling].value));
    }
  }
  return diagnostics.errors.empty() ? "" : diagnostics.errors.front();
}

namespace detail {

/// "depth_camera.yaml", or with a date and the camera called "camera": "depth_<date>.yaml".
[[nodiscard]] inline std::string camera_file(const char* kind, const std::string& camera,
                                             const ResultFileOptions& options) {
  std::string name = camera;
  std::replace(name.begin(), name.end(), '/', '_');
  if (options.date.empty()) return fmt::format("{}_{}.yaml", kind, name);
  return fmt::format("{}_{}{}.yaml", kind, name == "camera" ? "" : name + "_", options.date);
}

[[nodiscard]] inline std::string dated(const char* stem, const char* ending,
                                       const ResultFileOptions& options) {
  return options.date.empty() ? fmt::format("{}{}", stem, ending)
                              : fmt::format("{}_{}{}", stem, options.date, ending);
}

/// Parameters that some step freed, and those held at a value of their own.
[[nodiscard]] inline std::string values_yaml(const CalibrationResult& result) {
  std::string text;
  for (int i = 0; i < result.table.size(); ++i) {
    const auto& freed = result.calibrated;
    const bool calibrated = std::find(freed.begin(), freed.end(), i) != freed.end();
    if (!calibrated && result.table[i].value == 0.0) continue;
    text += fmt::format("{}: {}\n", name_to_yaml(result.table[i].name),
                        number_to_yaml(result.table[i].value));
  }
  return text;
}

}  // namespace detail

/// @param urdf_text  content of the URDF, as it was read
/// @param urdf_name  its name, for messages
[[nodiscard]] inline std::vector<OutputFile> result_files(
    const Robot& robot, const std::string& urdf_text, const std::string& urdf_name,
    const Calibration& calibration, const CalibrationResult& result,
    std::span<const Sample> samples, const ResultFileOptions& options) {
  std::vector<OutputFile> files;
  const std::string urdf = detail::dated("calibrated", ".urdf", options);
  files.push_back({urdf, patch_urdf(urdf_text, urdf_name, robot, joint_patches(robot, result.table),
                                    options.offsets)});
  std::string references;
  const auto refer = [&](const std::string& kind, const std::string& camera,
                         const std::string& file) {
    const bool first = references.find("\n" + kind + ":") == std::string::npos;
    const std::string key = first ? kind : camera + "_" + kind;
    references += fmt::format("\n{}: {}", name_to_yaml(key), name_to_yaml(file));
  };
  for (const CalibratedCamera& camera : calibrated_cameras(calibration, result.table, samples)) {
    const std::string& name = camera.sensor.name;
    const std::string content = to_camera_info_yaml(camera.info, name);
    if (camera.sensor.type == SensorType::camera3d) {
      files.push_back({detail::camera_file("depth", name, options), content});
      refer("depth_info", name, files.back().name);
    }
    files.push_back({detail::camera_file("rgb", name, options), content});
    refer("rgb_info", name, files.back().name);
  }
  std::string values = detail::values_yaml(result);
  if (!references.empty()) values += references.substr(1) + "\n";
  values += fmt::format("urdf: {}\n", urdf);
  files.push_back({detail::dated("calibration", ".yaml", options), values});
  return files;
}

}  // namespace kinecal
