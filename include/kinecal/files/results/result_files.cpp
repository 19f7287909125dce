// The content of a result's files: definitions of result_files.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/results/result_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/cameras/camera_fields.ipp"
#include "kinecal/files/cameras/camera_info.hpp"
#include "kinecal/files/results/arm_files.hpp"
#include "kinecal/files/results/base_file.hpp"
#include "kinecal/files/results/depth_file.hpp"
#include "kinecal/files/results/magnetometer_file.hpp"
#include "kinecal/files/results/result_text.ipp"
#include "kinecal/files/results/transform_files.hpp"
#include "kinecal/files/yaml/yaml_text.hpp"
#include "kinecal/parameters/joint_models/joint_models.hpp"
#include "kinecal/sensors/depth/depth_camera.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A camera of a calibration, with its parameters applied to the recorded settings.
struct CalibratedCamera {
  Mount mount;
  CameraInfo info;
  bool measures_depth = false;
  std::optional<CalibratedDepth> depth = {};  ///< of a camera3d
};

[[nodiscard]] std::vector<CalibratedCamera> calibrated_cameras(const Calibration& calibration,
                                                               const ParameterTable& table,
                                                               std::span<const Sample> samples) {
  std::vector<CalibratedCamera> cameras;
  for (const CalibrationStep& step : calibration.steps) {
    for (const MountedSensor& mounted : step.problem->sensors()) {
      const Mount& mount = mounted.mount();
      const auto same = [&](const auto& camera) { return camera.mount.name == mount.name; };
      if (std::any_of(cameras.begin(), cameras.end(), same)) continue;
      if (!mounted.sensor().is_camera()) continue;
      for (const Sample& sample : samples) {
        const Observation* seen = sample.observation(mount.name);
        if (seen == nullptr || !seen->camera) continue;
        const Eigen::VectorXd all = table.values();
        const std::vector<double> own =
            mounted.own_values({all.data(), static_cast<std::size_t>(all.size())});
        cameras.push_back({mount, mounted.sensor().calibrated(*seen->camera, own),
                           measures_depth(mounted.sensor())});
        if (mounted.sensor().type() == DepthCamera::kType) {
          cameras.back().depth =
              calibrated_depth(mounted, *seen, {all.data(), static_cast<std::size_t>(all.size())});
        }
        break;
      }
    }
  }
  return cameras;
}

/// True if some step freed a coefficient of a camera's polynomial.
[[nodiscard]] bool frees_bend(const CalibratedDepth& depth, const CalibrationResult& result) {
  return std::any_of(kDepthPolynomial.begin(), kDepthPolynomial.end(), [&](const auto& bend) {
    const int p = depth.parameters.at(std::string(bend.name));
    const auto& freed = result.calibrated;
    return p >= 0 && std::find(freed.begin(), freed.end(), p) != freed.end();
  });
}

}  // namespace
}  // namespace detail

std::vector<JointPatch> joint_patches(const Robot& robot, const ParameterTable& table,
                                      const std::set<std::string>& in_servos) {
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
    const bool has_zero =
        moves(joint.type) && !joint.mimic && in_servos.find(joint.name) == in_servos.end();
    JointPatch patch{joint.name, has_zero ? value(joint.name) : 0.0, {}};
    if (joint.mimic) {
      patch.mimic_multiplier = value(parameter_name(joint.name, MimicErrors::kParameters[0].name));
      patch.mimic_offset = value(parameter_name(joint.name, MimicErrors::kParameters[1].name));
    }
    const bool mimics_as_before = patch.mimic_multiplier == 0.0 && patch.mimic_offset == 0.0;
    if (frame.isZero(0.0) && patch.offset == 0.0 && mimics_as_before) continue;
    patch.correction = {exp(Vector3<double>(frame.tail<3>())), frame.head<3>()};
    patches.push_back(patch);
  }
  return patches;
}

std::string impossible_camera(const Calibration& calibration, const ParameterTable& table,
                              std::span<const Sample> samples) {
  Diagnostics diagnostics;
  for (const detail::CalibratedCamera& camera :
       detail::calibrated_cameras(calibration, table, samples)) {
    const SourceLocation place{"camera '" + camera.mount.name + "'", 0};
    detail::check_camera(camera.info, place, diagnostics);
    const std::string scaling = parameter_name(camera.mount.parameter_prefix(), "z_scaling");
    if (camera.measures_depth && !(table[scaling].value > -1.0)) {
      diagnostics.error(
          place, fmt::format("depth scale must be positive, is {}", 1.0 + table[scaling].value));
    }
    if (!camera.depth) continue;
    const std::string why = impossible_depth(*camera.depth, camera.mount.name, samples);
    if (!why.empty()) diagnostics.error(place, why);
  }
  return diagnostics.errors.empty() ? "" : diagnostics.errors.front();
}

std::vector<OutputFile> result_files(const Robot& robot, const std::string& urdf_text,
                                     const std::string& urdf_name, const Calibration& calibration,
                                     const CalibrationResult& result,
                                     std::span<const Sample> samples,
                                     const ResultFileOptions& options) {
  std::vector<OutputFile> files;
  const std::string urdf = detail::dated("calibrated", ".urdf", options.date);
  const std::vector<JointPatch> patches = joint_patches(robot, result.table, options.in_servos);
  files.push_back({urdf, patch_urdf(urdf_text, urdf_name, robot, patches, options.offsets)});
  for (OutputFile& file : arm_files(robot, patches, files.front().content, options.date)) {
    files.push_back(std::move(file));
  }
  for (OutputFile& file : transform_files(robot, result.table, samples)) {
    files.push_back(std::move(file));
  }
  std::string references;
  const auto refer = [&](const std::string& kind, const std::string& camera,
                         const std::string& file) {
    const bool first = references.find("\n" + kind + ":") == std::string::npos;
    const std::string key = first ? kind : camera + "_" + kind;
    references += fmt::format("\n{}: {}", detail::name_to_yaml(key), detail::name_to_yaml(file));
  };
  for (const detail::CalibratedCamera& camera :
       detail::calibrated_cameras(calibration, result.table, samples)) {
    const std::string& name = camera.mount.name;
    const std::string content = to_camera_info_yaml(camera.info, name);
    if (camera.measures_depth) {
      files.push_back({detail::camera_file("depth", name, options.date), content});
      refer("depth_info", name, files.back().name);
    }
    if (camera.depth && (camera.depth->bends() || detail::frees_bend(*camera.depth, result))) {
      files.push_back({detail::camera_file("depth_correction", name, options.date),
                       depth_correction_yaml(*camera.depth, name, options.deviations, samples)});
      refer("depth_correction", name, files.back().name);
    }
    files.push_back({detail::camera_file("rgb", name, options.date), content});
    refer("rgb_info", name, files.back().name);
  }
  if (const std::string base =
          base_calibration_yaml(calibration, result.table, options.deviations, options.drivers);
      !base.empty()) {
    files.push_back({detail::dated("base_calibration", ".yaml", options.date), base});
    refer("base", "", files.back().name);
  }
  if (const std::string field = magnetometer_yaml(calibration, result.table, options.deviations);
      !field.empty()) {
    files.push_back({detail::dated("magnetometer_calibration", ".yaml", options.date), field});
    refer("magnetometer", "", files.back().name);
  }
  std::string values = detail::values_yaml(robot, result, options.deviations);
  if (!references.empty()) values += references.substr(1) + "\n";
  values += fmt::format("urdf: {}\n", urdf);
  files.push_back({detail::dated("calibration", ".yaml", options.date), values});
  return files;
}

}  // namespace kinecal
