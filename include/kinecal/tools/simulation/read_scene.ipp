// Reads the keys of a scene file, for simulation_plan.cpp.
//
//   seed: 1                         same seed: same robot, noise and faults
//   camera:
//     frame: LINK, name: camera, type: camera3d | camera2d, info: FILE, image: raw | rectified
//     blur: 0.6 (pixels), exposure: 1.0, noise: 1.5 (of 255), nearest: 0.3, farthest: 5.0 (metres)
//     depth_noise: 0.001 (at 1 m), disparity_step: 0.125 (pixels), holes: true
//   target:
//     type: leds | checkerboard | apriltag | ground, link: LINK, xyz: [x, y, z], rpy: [r, p, y]
//     columns: 6, rows: 5, size: 0.025, leds: [[x, y, z], ...]
//   errors:                         each between half of it and all of it, with either sign
//     joint: 0.05, sliding: 0.01, position: 0.01, rotation: 0.02, intrinsics: 0.01, z_offset:
//     0.005, z_scaling: 0.01, values: {shoulder_pan_joint: 0.03}
//   noise: {pixel: 0.3, point: 5e-5 (metres), rotation: 1e-4}
//   motion: {speed: 1.0, encoder_noise: 2e-5, repeatability: 5e-5, backlash: 1e-4, image_rate: 15,
//            image_latency: 0.06, exposure_time: 0.0 (seconds), late_stamps: 0.0, lamp_latency:
//            0.04}
//   faults: {stuck_joint: NAME, joints_end: 60.0, views_end: 60.0, connection_ends: 60.0,
//            other_clock: 100.0, dark_led: 1, no_camera_info: true, passer_by: 0.1, outliers: 0.05}
//   poses: 30, or poses: FILE       as robot_calibration has them
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/read_config.hpp"
#include "kinecal/files/cameras/read_camera_file.hpp"
#include "kinecal/files/poses/poses.hpp"
#include "kinecal/files/yaml/config_map.ipp"
#include "kinecal/files/yaml/yaml_document.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/tools/simulation/scene_errors.ipp"

namespace kinecal::detail {

/// The path of a file named in a scene, relative to the scene.
[[nodiscard]] inline std::string beside(const SourceLocation& place, const std::string& file) {
  return (std::filesystem::path(place.file).parent_path() / file).string();
}

[[nodiscard]] inline std::optional<Vector3<double>> read_vector(ConfigMap& map,
                                                                const ConfigEntry& entry) {
  Vector3<double> vector = Vector3<double>::Zero();
  bool is_vector = entry.value.is_list() && entry.value.items.size() == 3;
  for (Eigen::Index i = 0; is_vector && i < 3; ++i) {
    const auto number = config_number(entry.value.items[static_cast<std::size_t>(i)]);
    is_vector = number && std::isfinite(*number);
    if (is_vector) vector(i) = *number;
  }
  if (is_vector) return vector;
  map.error(entry.place, (entry.key.empty() ? "a point" : entry.key) + " is " +
                             describe_config(entry.value) + ", not three numbers");
  return std::nullopt;
}

/// One of a few words; an error and nullopt for any other.
[[nodiscard]] inline std::optional<std::string> read_word(ConfigMap& map, const std::string& key,
                                                          const std::vector<std::string>& words) {
  std::optional<std::string> word = map.text(key);
  if (!word || std::find(words.begin(), words.end(), *word) != words.end()) return word;
  std::string all;
  for (const std::string& known : words) all += (all.empty() ? "" : ", ") + known;
  map.error(map.find(key)->place, key + " is '" + *word + "', not one of " + all);
  return std::nullopt;
}

/// The name of a link; an error and nullopt if the robot has no such link.
[[nodiscard]] inline std::optional<std::string> read_link(ConfigMap& map, const std::string& key,
                                                          const Robot& robot) {
  std::optional<std::string> link = map.text(key);
  if (!link || robot.has_link(*link)) return link;
  map.error(map.find(key)->place, key + ": no link '" + *link + "' in the URDF" +
                                      did_you_mean(*link, robot.link_names()));
  return std::nullopt;
}

inline void read_camera(ConfigMap& map, SimulationPlan& plan) {
  SimulatedCamera& camera = plan.setup.camera;
  camera.frame = read_link(map, "frame", plan.setup.robot).value_or(camera.frame);
  plan.setup.camera_name = map.text("name").value_or(plan.setup.camera_name);
  plan.camera_type = read_word(map, "type", {"camera3d", "camera2d"}).value_or("");
  if (const auto file = map.text("info")) {
    camera.info = read_camera_argument(beside(map.place(), *file), map.diagnostics());
  }
  const auto image = read_word(map, "image", {"raw", "rectified"});
  if (image) camera.image = *image == "raw" ? ImageKind::raw : ImageKind::rectified;
  for (const auto& [key, value] : {std::pair{"blur", &camera.blur},
                                   {"exposure", &camera.exposure},
                                   {"noise", &camera.noise},
                                   {"nearest", &camera.nearest},
                                   {"farthest", &camera.farthest},
                                   {"depth_noise", &camera.depth_noise},
                                   {"disparity_step", &camera.disparity_step}}) {
    *value = map.number(key, *value);
    if (*value < 0.0) map.error(map.find(key)->place, std::string(key) + " is below zero");
  }
  camera.has_holes = map.flag("holes", camera.has_holes);
  map.report_unknown();
}

inline void read_target(ConfigMap& map, SimulationPlan& plan) {
  SimulatedTarget& target = plan.target;
  target.type = read_word(map, "type", {"leds", "checkerboard", "apriltag", "aprilgrid", "ground"})
                    .value_or(target.type);
  target.link = read_link(map, "link", plan.setup.robot).value_or("");
  target.columns = map.count("columns", target.columns);
  target.rows = map.count("rows", target.rows);
  target.size = map.positive("size", target.size);
  target.has_pose = map.peek("xyz") != nullptr || map.peek("rpy") != nullptr;
  if (const ConfigEntry* xyz = map.find("xyz")) {
    target.pose.translation = read_vector(map, *xyz).value_or(Vector3<double>::Zero());
  }
  if (const ConfigEntry* rpy = map.find("rpy")) {
    target.pose.rotation =
        rotation_from_rpy(read_vector(map, *rpy).value_or(Vector3<double>::Zero()));
  }
  const ConfigEntry* given = map.peek("leds");
  for (const ConfigEntry& led : map.list("leds")) {
    target.leds.push_back(read_vector(map, led).value_or(Vector3<double>::Zero()));
  }
  if (given != nullptr && given->value.is_list() && target.leds.empty()) {
    map.error(given->place, "leds is empty; give the point of at least one LED, or leave it out");
  }
  map.report_unknown();
}

inline void read_plan_poses(ConfigMap& map, SimulationPlan& plan) {
  const ConfigEntry* entry = map.find("poses");
  if (entry == nullptr) return;
  if (config_number(entry->value)) {
    plan.poses = map.count("poses", plan.poses);
  } else if (const auto file = map.text("poses")) {
    for (CapturePose& pose : read_poses_yaml(beside(map.place(), *file), map.diagnostics())) {
      plan.given.push_back({std::move(pose.joint_names), std::move(pose.positions)});
    }
  }
}

/// Sets the noise of features from that of the camera and of the joints.
inline void set_noise(SimulationPlan& plan) {
  const SimulatedTiming& timing = plan.setup.timing;
  plan.noise.depth = plan.setup.camera.depth_noise;
  plan.noise.joint = std::hypot(timing.encoder_noise, timing.repeatability, 0.5 * timing.backlash);
}

/// Reads a scene file into a plan.
/// @returns  errors given in the file
[[nodiscard]] inline ParameterTable read_scene(const std::string& path, SimulationPlan& plan,
                                               Diagnostics& diagnostics) {
  ParameterTable given;
  const YamlNode content = load_config(path, diagnostics);
  if (!content.is_map()) {
    diagnostics.error({path, 0}, describe_wrong_file(content, "a scene"));
    return given;
  }
  ConfigMap map(content, {path, content.line}, "", diagnostics);
  plan.setup.seed = static_cast<std::uint64_t>(map.count("seed", 1));
  if (auto camera = map.map("camera", "camera")) read_camera(*camera, plan);
  if (auto target = map.map("target", "target")) read_target(*target, plan);
  if (auto errors = map.map("errors", "errors")) given = read_errors(*errors, plan.errors);
  if (auto noise = map.map("noise", "noise")) read_noise(*noise, plan.noise);
  if (auto motion = map.map("motion", "motion")) read_motion(*motion, plan.setup);
  if (auto faults = map.map("faults", "faults")) read_faults(*faults, plan.setup.faults);
  read_plan_poses(map, plan);
  map.report_unknown();
  return given;
}

}  // namespace kinecal::detail
