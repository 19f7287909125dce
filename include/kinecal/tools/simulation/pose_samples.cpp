// Definitions of pose_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/tools/simulation/pose_samples.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/samples/joint_moves.hpp"
#include "kinecal/sensors/lenses/lens.hpp"
#include "kinecal/study/true_robot.hpp"
#include "kinecal/text/frame_name.hpp"
#include "kinecal/tools/simulation/place_target.ipp"

namespace kinecal {

namespace detail {
namespace {

// The models and target features that a study simulates.

/// The features of a target in its own frame: LEDs in their link.
[[nodiscard]] std::vector<Vector3<double>> features_of(const SimulatedTarget& target) {
  std::vector<Vector3<double>> points;
  if (!is_board(target)) return points_of(target);
  const bool tags = has_tags(target);
  const TagGridShape shape = tags_of(target);
  const double step = tags ? target.size * (1.0 + double(shape.gap) / shape.tag()) : target.size;
  for (int row = 0; row < target.rows; ++row) {
    for (int column = 0; column < target.columns; ++column) {
      const Vector3<double> corner(column * step, row * step, 0.0);
      if (!tags) points.push_back(corner);
      if (!tags) continue;
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        points.push_back(corner + target.size * Vector3<double>(x, y, 0.0));
      }
    }
  }
  return points;
}

/// Joints at zero, or at the nearest limit.
[[nodiscard]] Positions at_rest(const Robot& robot) {
  Positions positions;
  for (const Joint& joint : robot.joints()) {
    if (!moves(joint.type) || joint.mimic) continue;
    const auto& limits = joint.limits;
    positions[joint.name] = limits && limits->lower < limits->upper
                                ? std::clamp(0.0, limits->lower, limits->upper)
                                : 0.0;
  }
  return positions;
}

/// The models that a study simulates.
struct StudiedModels {
  const ModelConfig* camera = nullptr;
  const ModelConfig* chain = nullptr;
  std::string frame = {};  ///< the virtual frame of the target; empty: its points are in the link
};

[[nodiscard]] StudiedModels studied_models(const SimulationPlan& plan, const Config& config) {
  const StepConfig& step = config.steps.back();
  const auto model = [&](const std::string& name) -> const ModelConfig* {
    for (const ModelConfig& of : step.models) {
      if (of.name == name) return &of;
    }
    return nullptr;
  };
  for (const BlockConfig& block : step.error_blocks) {
    if (block.models.size() != 2) continue;
    StudiedModels models{model(block.models[0]), model(block.models[1])};
    if (models.camera == nullptr || models.chain == nullptr) continue;
    if (!models.camera->type.starts_with("camera")) std::swap(models.camera, models.chain);
    if (!same_frame(models.camera->frame, plan.setup.camera.frame)) continue;
    if (models.chain->type.starts_with("camera")) continue;
    for (const FreeFrameConfig& frame : step.free_frames) {
      if (is_board(plan.target) && !plan.setup.robot.has_joint(frame.name))
        models.frame = frame.name;
    }
    return models;
  }
  throw InputError(config.place.file + ": no error block compares a camera in '" +
                   plan.setup.camera.frame +
                   "' with a chain; give recorded samples, whose features are then simulated");
}

/// Makes the samples of poses.
class PoseSampling {
 public:
  PoseSampling(const SimulationPlan& plan, const Config& config)
      : plan_(plan),
        models_(studied_models(plan, config)),
        nominal_(plan.setup.robot, {}, {}),
        points_(features_of(plan.target)),
        lens_(plan.setup.camera.info, plan.setup.camera.image) {
    link_T_points_ = is_board(plan.target) ? plan.target.pose : Pose<double>{};
    chain_T_link_ = rigid(models_.chain->frame, plan.target.link);
  }

  /// The pose of the target's frame, as parameters.
  [[nodiscard]] ParameterTable values() const {
    ParameterTable values;
    if (models_.frame.empty()) return values;
    const Pose<double> pose = chain_T_link_ * link_T_points_;
    const Vector3<double> turn = log(pose.rotation);
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
      values.add({.name = parameter_name(models_.frame, kFrameAxes[static_cast<std::size_t>(axis)]),
                  .value = axis < 3 ? pose.translation(axis) : turn(axis - 3)});
    }
    return values;
  }

  /// The sample of a pose, or why it is missing.
  [[nodiscard]] std::pair<std::optional<Sample>, std::string> sample(
      const CapturePose& pose) const {
    Sample sample = sample_in_pose(plan_.setup.robot, pose);
    Positions positions;
    for (std::size_t i = 0; i < sample.joint_names.size(); ++i) {
      positions[sample.joint_names[i]] = sample.joint_positions[i];
    }
    Observation seen{models_.camera->name, {}, plan_.setup.camera.info},
        held{models_.chain->name, {}};
    const Pose<double> camera_T_points =
        nominal_.pose(plan_.setup.camera.frame, plan_.target.link, positions) * link_T_points_;
    std::string why;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3<double> p = camera_T_points * points_[i];
      const std::string fault = view_fault(p);
      if (!fault.empty()) why = fault;
      if (!fault.empty()) continue;
      const bool in_chain = models_.frame.empty();
      const int id = static_cast<int>(i);
      seen.features.push_back({models_.camera->frame, measured(p), {}, {}, id});
      held.features.push_back(
          {in_chain ? models_.chain->frame : models_.frame,
           in_chain ? chain_T_link_ * (link_T_points_ * points_[i]) : points_[i],
           {},
           {},
           id});
    }
    if (seen.features.empty()) return {std::nullopt, why};
    sample.observations = {seen, held};
    return {sample, ""};
  }

 private:
  /// a_T_b of two links that do not move against each other.
  [[nodiscard]] Pose<double> rigid(const std::string& a, const std::string& b) const {
    for (const ChainJoint& joint : make_chain(plan_.setup.robot, a, b, {}).joints) {
      if (!moves(joint.type)) continue;
      throw InputError("the target is on '" + b + "', which moves against '" + a +
                       "', the frame of '" + models_.chain->name +
                       "'; put it there in the scene: target: {link: " + a + "}");
    }
    return nominal_.pose(a, b, at_rest(plan_.setup.robot));
  }

  [[nodiscard]] Eigen::Vector2d pixel(const Vector3<double>& p) const { return lens_.project(p); }

  [[nodiscard]] std::string view_fault(const Vector3<double>& p) const {
    const SimulatedCamera& camera = plan_.setup.camera;
    if (!(p.z() > 0.05)) return "the target is behind the camera";
    if (camera.has_depth && (p.z() < camera.nearest || p.z() > camera.farthest)) {
      return "the target is too near or too far for the camera's depth";
    }
    const Eigen::Vector2d at = pixel(p);
    const bool in_image = at.x() > 0.0 && at.y() > 0.0 && at.x() < camera.info.width - 1 &&
                          at.y() < camera.info.height - 1;
    return in_image ? "" : "the target is outside of the image";
  }

  [[nodiscard]] Vector3<double> measured(const Vector3<double>& p) const {
    if (measures_depth(*entry_of(*models_.camera)->sensor)) return p;
    const Eigen::Vector2d at = pixel(p);
    return {at.x(), at.y(), 0.0};
  }

  const SimulationPlan& plan_;
  StudiedModels models_;
  TrueRobot nominal_;
  std::vector<Vector3<double>> points_;
  Lens lens_;
  Pose<double> link_T_points_, chain_T_link_;
};

}  // namespace
}  // namespace detail

Sample sample_in_pose(const Robot& robot, const CapturePose& pose) {
  Positions positions = detail::at_rest(robot);
  for (std::size_t i = 0; i < pose.joint_names.size(); ++i) {
    positions[pose.joint_names[i]] = pose.positions[i];
  }
  Sample sample = sample_at(positions);
  sample.joint_velocities.assign(positions.size(), 0.0);
  sample.source = pose.source;
  return sample;
}

PoseSamples pose_samples(const SimulationPlan& plan, const Config& config,
                         const std::vector<CapturePose>& poses) {
  if (plan.target.type == "ground" || plan.target.type == "robot") {
    throw InputError("a study has no " +
                     std::string(plan.target.type == "ground" ? "floor" : "robot") +
                     " as its target; choose leds, checkerboard, apriltag or "
                     "aprilgrid");
  }
  const detail::PoseSampling sampling(plan, config);
  PoseSamples result;
  result.values = sampling.values();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto [sample, why] = sampling.sample(poses[i]);
    if (!sample) {
      result.skipped.push_back(poses[i].source + ": " + why);
      continue;
    }
    result.samples.push_back(std::move(*sample));
    result.poses.push_back(i);
  }
  set_joint_moves(result.samples);
  return result;
}

}  // namespace kinecal
