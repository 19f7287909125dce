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

#include "kinecal/capture/homography.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/parameters_from_config.hpp"
#include "kinecal/geometry/rpy.hpp"
#include "kinecal/problem/sampled_chain.hpp"
#include "kinecal/samples/paired_features.hpp"
#include "kinecal/sensors/lens.hpp"
#include "kinecal/tools/cameras/camera_start.hpp"
#include "kinecal/tools/cameras/single_camera.hpp"

namespace kinecal {

namespace detail {
namespace {

/// A camera that sees a target with a pose of its own, by the error block that compares them.
struct TargetPair {
  const ModelConfig* target = nullptr;
  const ModelConfig* camera = nullptr;
  std::string joint;  ///< the floating joint of the target
};

/// The pairs of a configuration.
[[nodiscard]] std::vector<TargetPair> target_pairs(const Config& config, const Robot& robot) {
  std::vector<TargetPair> pairs;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = registry().block(block.type);
      if (entry == nullptr || entry->read_as != PointToPixel::kType) continue;
      TargetPair pair;
      for (const ModelConfig& model : step.models) {
        if (model.name == block.models[0]) pair.target = &model;
        if (model.name == block.models[1]) pair.camera = &model;
      }
      if (pair.target == nullptr || pair.camera == nullptr) continue;
      const Joint* above =
          robot.has_link(pair.target->frame) ? robot.parent_joint(pair.target->frame) : nullptr;
      for (const FreeParamConfig& frame : config.per_sample) {
        if (above != nullptr && above->name == frame.name) pair.joint = frame.name;
      }
      const bool known = std::any_of(pairs.begin(), pairs.end(), [&](const TargetPair& other) {
        return other.target->name == pair.target->name && other.camera->name == pair.camera->name;
      });
      if (!pair.joint.empty() && !known) pairs.push_back(pair);
    }
  }
  return pairs;
}

/// The view of a pair in a sample; no corners if there is none, or the target is not flat.
[[nodiscard]] TargetView target_view(const TargetPair& pair, const Sample& given) {
  const ComparedSensors both{{pair.target->name, pair.camera->name}};
  const std::optional<Sample> paired =
      has_ids(given) ? pair_features(given, std::span(&both, 1)) : std::nullopt;
  const Sample& sample = paired ? *paired : given;
  const Observation *target = sample.observation(pair.target->name),
                    *camera = sample.observation(pair.camera->name);
  TargetView view;
  if (target == nullptr || camera == nullptr) return view;
  const std::size_t count = std::min(target->features.size(), camera->features.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3<double>&on = target->features[i].point, &seen = camera->features[i].point;
    if (!on.allFinite() || !seen.allFinite()) continue;
    constexpr double kFlat = 1e-6;  // metres
    if (std::abs(on.z() - target->features[0].point.z()) > kFlat) return {};
    view.plane.emplace_back(on.head<2>());
    view.pixels.emplace_back(seen.head<2>());
  }
  return view;
}

/// The camera_info of a camera in some sample; nullptr if none has one.
[[nodiscard]] const CameraInfo* info_of(const std::string& camera,
                                        const std::vector<Sample>& samples) {
  for (const Sample& sample : samples) {
    const Observation* seen = sample.observation(camera);
    if (seen != nullptr && seen->camera) return &*seen->camera;
  }
  return nullptr;
}

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

/// Gives a camera its first intrinsics in all samples.
void set_info(const std::string& camera, const CameraInfo& found, std::vector<Sample>& samples) {
  for (Sample& sample : samples) {
    for (Observation& seen : sample.observations) {
      if (seen.sensor != camera) continue;
      if (!seen.camera) seen.camera.emplace();
      const int width = seen.camera->width, height = seen.camera->height;
      seen.camera = found;
      seen.camera->width = width;
      seen.camera->height = height;
    }
  }
}

/// camera_T_target of each sample that has it, by a camera that is known.
[[nodiscard]] std::map<std::size_t, Pose<double>> poses_by(const CameraInfo& info, ImageKind image,
                                                           const std::vector<TargetView>& views) {
  std::map<std::size_t, Pose<double>> poses;
  const Lens lens(info, image);
  for (std::size_t s = 0; s < views.size(); ++s) {
    std::vector<Eigen::Vector2d> plane;
    std::vector<Vector3<double>> directions;
    for (std::size_t i = 0; i < views[s].pixels.size(); ++i) {
      const Vector3<double> ray = lens.ray(views[s].pixels[i].x(), views[s].pixels[i].y());
      if (!ray.allFinite()) continue;
      plane.push_back(views[s].plane[i]);
      directions.push_back(ray);
    }
    if (directions.size() < 4) continue;
    if (const auto pose = plane_pose(plane, directions)) poses.emplace(s, *pose);
  }
  return poses;
}

/// A camera with the poses of a target in it, by sample.
struct SeenTarget {
  TargetPair pair;
  std::map<std::size_t, Pose<double>> poses;  ///< camera_T_target
};

/// The pose of one camera in another from the samples that they share: that with the smallest sum of distances to the
/// others.
[[nodiscard]] std::optional<Pose<double>> between(const SeenTarget& a, const SeenTarget& b) {
  if (a.pair.joint != b.pair.joint) return std::nullopt;
  std::vector<Pose<double>> all;
  for (const auto& [s, in_a] : a.poses) {
    const auto in_b = b.poses.find(s);
    if (in_b != b.poses.end()) all.push_back(in_a * in_b->second.inverse());
  }
  const auto distance = [](const Pose<double>& x, const Pose<double>& y) {
    return (x.translation - y.translation).norm() +
           log(Matrix3<double>(x.rotation.transpose() * y.rotation)).norm();
  };
  std::optional<Pose<double>> best;
  double least = HUGE_VAL;
  for (const Pose<double>& one : all) {
    double sum = 0.0;
    for (const Pose<double>& other : all) sum += distance(one, other);
    if (sum >= least) continue;
    least = sum;
    best = one;
  }
  return best;
}

/// base_T_link in a sample, without corrections; nullopt if the sample lacks a joint.
[[nodiscard]] std::optional<Pose<double>> pose_of_link(const Config& config, const Robot& robot,
                                                       const std::string& link,
                                                       const Sample& sample) {
  const SampledChain chain(robot, make_chain(robot, config.base_link, link), ParameterTable{});
  if (!chain.has_joints(sample)) return std::nullopt;
  return chain.tip(sample, Corrections<double>(chain.chain().joints.size()));
}

/// True if a camera stands on the base by a fixed joint whose whole frame is free without an initial value.
[[nodiscard]] bool is_placed_by_us(const Config& config, const Robot& robot,
                                   const ModelConfig& camera) {
  const Joint* joint = robot.has_link(camera.frame) ? robot.parent_joint(camera.frame) : nullptr;
  if (joint == nullptr || joint->type != JointType::fixed || joint->parent != config.base_link) {
    return false;
  }
  bool free = false;
  for (const StepConfig& step : config.steps) {
    for (const FreeFrameConfig& frame : step.free_frames) {
      const bool whole =
          std::all_of(frame.axes.begin(), frame.axes.end(), [](bool f) { return f; });
      free = free || (frame.name == joint->name && whole);
    }
    for (const FrameInitialValueConfig& value : step.frame_initial_values) {
      if (value.name == joint->name) return false;
    }
  }
  return free;
}

/// True if all intrinsics of a camera are free in some step.
[[nodiscard]] bool has_free_intrinsics(const Config& config, const ModelConfig& camera) {
  const std::shared_ptr<const AnySensor> sensor = sensor_of(camera);
  const auto all = sensor->parameters().first(kIntrinsics);
  return std::all_of(all.begin(), all.end(), [&](const ParameterInfo& info) {
    const std::string name = parameter_name(camera.param_name, info.name);
    return std::any_of(config.steps.begin(), config.steps.end(), [&](const StepConfig& step) {
      return std::any_of(step.free_params.begin(), step.free_params.end(),
                         [&](const FreeParamConfig& free) { return free.name == name; });
    });
  });
}

/// base_T_camera of each camera that is fixed to the base, as far as the robot, or samples that it shares with a camera that
/// is known, say.
[[nodiscard]] std::map<std::string, Pose<double>> place_cameras(
    Config& config, const Robot& robot, const std::vector<SeenTarget>& seen) {
  std::map<std::string, Pose<double>> known;
  std::vector<const SeenTarget*> open;
  for (const SeenTarget& of : seen) {
    const ModelConfig& camera = *of.pair.camera;
    if (is_placed_by_us(config, robot, camera)) {
      open.push_back(&of);
    } else if (const RuntimeChain chain = make_chain(robot, config.base_link, camera.frame);
               chain.joints.empty()) {
      known.emplace(camera.name, chain.tail);
    }
  }
  for (bool found = true; found;) {
    found = false;
    for (const SeenTarget& of : seen) {
      const auto at = known.find(of.pair.camera->name);
      if (at == known.end()) continue;
      for (const SeenTarget* next : open) {
        const auto a_T_b = between(of, *next);
        if (!a_T_b || known.contains(next->pair.camera->name)) continue;
        const Pose<double> base_T_camera = at->second * *a_T_b;
        known.emplace(next->pair.camera->name, base_T_camera);
        const Joint& joint = *robot.parent_joint(next->pair.camera->frame);
        const Pose<double> frame = joint.origin.inverse() * base_T_camera;
        config.steps.front().frame_initial_values.push_back(
            {joint.name, frame.translation, rpy_from_rotation(frame.rotation), config.place});
        found = true;
      }
    }
  }
  return known;
}

/// The poses of targets in the samples.
void set_poses(const Config& config, const Robot& robot, const std::vector<SeenTarget>& seen,
               const std::map<std::string, Pose<double>>& cameras, std::vector<Sample>& samples) {
  for (std::size_t s = 0; s < samples.size(); ++s) {
    for (const SeenTarget& of : seen) {
      Sample& sample = samples[s];
      const auto pose = of.poses.find(s);
      if (pose == of.poses.end() || sample.poses.contains(of.pair.joint)) continue;
      const auto placed = cameras.find(of.pair.camera->name);
      const std::optional<Pose<double>> camera =
          placed != cameras.end() ? placed->second
                                  : pose_of_link(config, robot, of.pair.camera->frame, sample);
      const Joint& joint = robot.joint(of.pair.joint);
      const auto parent = pose_of_link(config, robot, joint.parent, sample);
      if (!camera || !parent) continue;
      sample.poses[of.pair.joint] = (*parent * joint.origin).inverse() * *camera * pose->second;
    }
  }
}

}  // namespace
}  // namespace detail

void start_cameras(Config& config, const Robot& robot, std::vector<Sample>& samples,
                   Diagnostics& diagnostics) {
  const std::vector<detail::TargetPair> pairs = detail::target_pairs(config, robot);
  std::vector<detail::SeenTarget> seen;
  for (const detail::TargetPair& pair : pairs) {
    std::vector<TargetView> views;
    for (const Sample& sample : samples) views.push_back(detail::target_view(pair, sample));
    const CameraInfo* info = detail::info_of(pair.camera->name, samples);
    detail::SeenTarget of{pair, {}};
    if (info != nullptr && (info->k[0] > 0.0 || info->p[0] > 0.0)) {
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
      const auto single =
          single_camera(views, size[0], size[1], detail::options_of(*pair.camera).lens);
      if (!single) {
        diagnostics.error(pair.camera->place,
                          fmt::format("camera '{}': no view of '{}' has four corners of a flat "
                                      "target, so nothing says where to begin; give its "
                                      "intrinsics",
                                      pair.camera->name, pair.target->name));
        continue;
      }
      detail::set_info(pair.camera->name, single->info, samples);
      for (std::size_t s = 0; s < views.size(); ++s) {
        if (single->poses[s]) of.poses.emplace(s, *single->poses[s]);
      }
    }
    seen.push_back(std::move(of));
  }
  const auto cameras = detail::place_cameras(config, robot, seen);
  detail::set_poses(config, robot, seen, cameras, samples);
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
}

}  // namespace kinecal
