// Definitions of sensor_points.hpp.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/config/doubts/sensor_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "kinecal/config/doubts/camera_features.ipp"
#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/point_spreads.ipp"
#include "kinecal/config/doubts/same_feature.ipp"
#include "kinecal/config/registry.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal::detail {

/// Adds the model's points in one sample.
/// @param first  the observation of the first sample with one
inline void add_points(RecordedPoints& all, const Observation& seen, std::size_t sample,
                       const Observation& first) {
  for (std::size_t i = 0; i < seen.features.size(); ++i) {
    const Feature& feature = seen.features[i];
    if (!feature.id && seen.features.size() != first.features.size()) all.is_constant = false;
    const Feature* before = all.is_constant ? same_feature(first, feature, i) : nullptr;
    if (before != nullptr) {
      all.is_constant = feature.point == before->point && feature.frame == before->frame;
    }
    if (!feature.point.allFinite()) continue;
    all.points.push_back(feature.point);
    all.samples.push_back(sample);
  }
}

std::vector<RecordedPoints> recorded_points(const Config& config, const Robot& robot,
                                            std::span<const Sample> samples) {
  std::vector<RecordedPoints> all;
  const std::set<std::string> pixels = pixel_models(config);
  for (const ModelConfig& model : models_of(config)) {
    const SensorEntry* entry = entry_of(model);
    if (entry == nullptr || !robot.has_link(model.frame)) continue;
    RecordedPoints recorded{model,
                            make_chain(robot, config.base_link, model.frame),
                            false,
                            false,
                            !pixels.contains(model.name),
                            true,
                            {},
                            {}};
    for (const ChainJoint& joint : recorded.chain.joints) {
      recorded.moves = recorded.moves || kinecal::moves(joint.type);
    }
    recorded.is_measured = !entry->sensor->parameters().empty();
    const Observation* first = nullptr;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const Observation* seen = samples[s].observation(model.name);
      if (seen == nullptr) continue;
      if (first == nullptr) first = seen;
      add_points(recorded, *seen, s, *first);
    }
    if (!recorded.points.empty()) all.push_back(std::move(recorded));
  }
  return all;
}

double reach_of(const Robot& robot, const RuntimeChain& chain) {
  double reach = chain.tail.translation.norm();
  for (const ChainJoint& joint : chain.joints) {
    reach += joint.fixed.translation.norm();
    if (joint.type != JointType::prismatic || !robot.has_joint(joint.name)) continue;
    const auto& limits = robot.joint(joint.name).limits;
    if (!limits) continue;
    const double travel = std::max(std::abs(limits->lower), std::abs(limits->upper));
    if (travel < 100.0) reach += travel;  // larger values stand for no limit
  }
  return reach;
}

/// Error: absurd coordinates.
/// @returns  true if there are any
inline bool report_absurd_points(const RecordedPoints& recorded, std::span<const Sample> samples,
                                 Diagnostics& diagnostics) {
  const double most = recorded.in_metres ? 1e5 : 1e6;  // metres, or pixels and readings
  Occurrences absurd;
  double first = 0.0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const double size = recorded.points[i].cwiseAbs().maxCoeff();
    if (size <= most) continue;
    if (absurd.count > 0 && last == recorded.samples[i]) continue;  // the sample is counted
    last = recorded.samples[i];
    if (absurd.add(last)) first = size;
  }
  if (absurd.count == 0) return false;
  diagnostics.error(place_of(samples, absurd.first),
                    fmt::format("sensor '{}' has a feature with the number {:.6g}{}; correct or "
                                "remove the sample",
                                recorded.model.name, first, absurd.others()));
  return true;
}

/// Size of the recorded points: their distance from a moving sensor, their extent for a fixed one,
/// because a tracker may stand far away.
[[nodiscard]] inline double size_of(const RecordedPoints& recorded) {
  std::vector<double> sizes;
  Vector3<double> center = Vector3<double>::Zero();
  if (!recorded.moves) {
    for (const auto& point : recorded.points) center += point;
    center /= static_cast<double>(recorded.points.size());
  }
  for (const auto& point : recorded.points) sizes.push_back((point - center).norm());
  return median_of(std::move(sizes));  // half of the points are as large
}

/// Error or doubt: points further away than the robot's size.
inline void check_distances(const RecordedPoints& recorded, double reach,
                            std::span<const Sample> samples, Diagnostics& diagnostics) {
  const double size = size_of(recorded), scale = reach + 0.5;  // metres: the smallest robots, too
  const double most = recorded.is_measured && recorded.moves ? 10.0 : 6.0;
  const SourceLocation place = place_of(samples, recorded.samples.front());
  const std::string text = fmt::format(
      "points of sensor '{}' are {:.4g} m {}; the robot's links between base and sensors are "
      "{:.3g} "
      "m long",
      recorded.model.name, size, recorded.moves ? "away" : "apart", reach);
  const bool is_mounted = recorded.moves && recorded.is_constant;  // LEDs in the gripper
  const double surely = is_mounted ? std::max(10.0 * scale, 10.0) : std::max(40.0 * scale, 30.0);
  if (size > surely) {
    diagnostics.error(place, text + "; they look like millimetres; points must be in metres");
  } else if (size > most * scale) {
    diagnostics.doubt(place, text + "; are they in metres?");
  } else if (recorded.is_measured && recorded.moves && size < 0.01) {
    diagnostics.error(place, text + "; no camera sees so close; points must be in metres");
  }
}

void check_sensor_points(const Config& config, const Robot& robot, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  check_principal_points(samples, diagnostics);
  const std::vector<RecordedPoints> all = recorded_points(config, robot, samples);
  double reach = 0.0;
  for (const RecordedPoints& recorded : all) {
    reach = std::max(reach, reach_of(robot, recorded.chain));
  }
  for (const Sample& sample : samples) {
    for (const auto& [joint, pose] : sample.poses) {
      reach = std::max(reach, pose.translation.norm());
    }
  }
  for (const RecordedPoints& recorded : all) {
    if (report_absurd_points(recorded, samples, diagnostics)) continue;
    check_frozen(recorded, samples, diagnostics);
    const SensorEntry* entry = entry_of(recorded.model);
    if (recorded.in_metres) {
      check_distances(recorded, reach, samples, diagnostics);
      if (measures_depth(*entry->sensor)) {
        check_depth_points(recorded, samples, diagnostics);
      }
    } else if (entry->sensor->delivers(Quantity::pixel)) {
      check_pixels(recorded, samples, diagnostics);
    }
  }
}

}  // namespace kinecal::detail
