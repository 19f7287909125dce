// Definitions of start_cameras.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/cameras/start_cameras.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/sensors/lens.hpp"
#include "kinecal/tools/cameras/camera_agreement.ipp"
#include "kinecal/tools/cameras/camera_checks.ipp"
#include "kinecal/tools/cameras/camera_places.ipp"
#include "kinecal/tools/cameras/known_cameras.ipp"
#include "kinecal/tools/cameras/single_camera.hpp"
#include "kinecal/tools/cameras/target_poses.ipp"

namespace kinecal {

namespace detail {
namespace {

/// The size of a camera's image: as recorded, or as far as corners lie around its middle.
[[nodiscard]] std::array<double, 2> image_size_of(const CameraInfo* info,
                                                  std::span<const TargetView> views) {
  if (info != nullptr && info->width > 0 && info->height > 0) {
    return {double(info->width), double(info->height)};
  }
  Eigen::AlignedBox2d box;
  for (const TargetView& view : views) {
    for (const Eigen::Vector2d& pixel : view.pixels) box.extend(pixel);
  }
  return {box.min().x() + box.max().x() + 1.0, box.min().y() + box.max().y() + 1.0};
}

/// True if a parameter of a camera is free in some step.
[[nodiscard]] bool is_free(const Config& config, const std::string& name) {
  return std::any_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
    return std::any_of(step.free_params.begin(), step.free_params.end(),
                       [&](const FreeParamConfig& free) { return free.name == name; });
  });
}

/// False if a camera was not found: no lens images the target as it was seen.
[[nodiscard]] bool is_finite(const CameraInfo& info) {
  const auto number = [](double value) { return std::isfinite(value); };
  return std::all_of(info.k.begin(), info.k.end(), number) &&
         std::all_of(info.d.begin(), info.d.end(), number);
}

/// Makes the coefficients zero that are held: nothing is known of them.
void drop_held(const Config& config, const ModelConfig& camera, CameraInfo& info) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const auto coefficients = sensor->parameters().subspan(kIntrinsics);
  for (std::size_t i = 0; i < std::min(coefficients.size(), info.d.size()); ++i) {
    if (!is_free(config, parameter_name(camera.param_name, coefficients[i].name))) info.d[i] = 0.0;
  }
}

/// True if all intrinsics of a camera are free in some step.
[[nodiscard]] bool has_free_intrinsics(const Config& config, const ModelConfig& camera) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const auto all = sensor->parameters().first(kIntrinsics);
  return std::all_of(all.begin(), all.end(), [&](const ParameterInfo& info) {
    return is_free(config, parameter_name(camera.param_name, info.name));
  });
}

}  // namespace
}  // namespace detail

void start_cameras(Config& config, const Robot& robot, std::vector<Sample>& samples,
                   Diagnostics& diagnostics) {
  const std::vector<detail::TargetPair> pairs = detail::target_pairs(config, robot);
  if (!detail::check_sensors(config, pairs, samples, diagnostics)) return;
  std::vector<detail::SeenTarget> seen;
  for (const detail::TargetPair& pair : pairs) {
    const std::vector<TargetView> views = detail::views_of(pair, samples);
    const CameraInfo* info = detail::info_of(pair.camera->name, samples);
    if (!detail::check_sizes(*pair.camera, samples, diagnostics)) continue;
    detail::SeenTarget of{pair, {}};
    if (detail::is_known(info)) {
      of.poses = detail::poses_by(*info, pair.camera->image, views);
    } else {
      if (!detail::has_free_intrinsics(config, *pair.camera)) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{0}': its intrinsics are not known; free {0}_fx, "
                                      "{0}_fy, {0}_cx, {0}_cy and the coefficients of its lens, or "
                                      "give them",
                                      pair.camera->param_name));
        continue;
      }
      const std::array<double, 2> size = detail::image_size_of(info, views);
      auto single = single_camera(views, size[0], size[1], detail::options_of(*pair.camera).lens);
      if (!single) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{}': no view of '{}' has four corners of a flat "
                                      "target, so nothing says where to begin; give its "
                                      "intrinsics",
                                      pair.camera->name, pair.target->name));
        continue;
      }
      if (!detail::is_finite(single->info)) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{}': no lens fits its views of '{}'; are the "
                                      "columns, rows and ids of the target right?",
                                      pair.camera->name, pair.target->name));
        continue;
      }
      if (!pair.camera->lens.empty()) detail::drop_held(config, *pair.camera, single->info);
      detail::set_info(pair.camera->name, single->info, samples);
      for (std::size_t s = 0; s < views.size(); ++s) {
        if (single->poses[s]) of.poses.emplace(s, *single->poses[s]);
      }
    }
    detail::drop_unseen(pair, *detail::info_of(pair.camera->name, samples), views, of.poses);
    seen.push_back(std::move(of));
  }
  detail::check_agreement(config, robot, seen, samples, diagnostics);
  const auto cameras = detail::place(config, robot, seen, samples);
  for (const detail::SeenTarget& of : seen) {
    const bool is_lost = detail::is_placed_by_us(config, robot, *of.pair.camera) &&
                         !cameras.contains(of.pair.camera->name);
    if (!is_lost) continue;
    diagnostics.error(
        of.pair.camera->place,
        fmt::format("camera '{}' shares no sample with a camera whose place on the base is known; "
                    "record the target where both see it, or give its frame an initial value",
                    of.pair.camera->name));
  }
  if (diagnostics.errors.empty()) detail::drop_unplaced(pairs, samples, diagnostics);
}

}  // namespace kinecal
