// Definitions of sensor_points.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "kinecal/io/doubts/occurrences.hpp"
#include "kinecal/io/doubts/point_spreads.ipp"
#include "kinecal/io/doubts/sensor_points.hpp"
#include "kinecal/io/registry.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal::detail {

/// Adds what the model saw in one sample.
/// @param first  the observation of the first sample with one
inline void add_points(RecordedPoints& all, const Observation& seen, std::size_t sample,
                       const Observation& first) {
  all.is_constant = all.is_constant && seen.features.size() == first.features.size();
  for (std::size_t i = 0; i < seen.features.size(); ++i) {
    const Feature& feature = seen.features[i];
    if (all.is_constant) {
      all.is_constant =
          feature.point == first.features[i].point && feature.frame == first.features[i].frame;
    }
    if (!feature.point.allFinite()) continue;
    all.points.push_back(feature.point);
    all.samples.push_back(sample);
  }
}

KINECAL_INLINE std::vector<RecordedPoints> recorded_points(const Config& config, const Robot& robot,
                                                           std::span<const Sample> samples) {
  std::vector<RecordedPoints> all;
  const std::set<std::string> pixels = pixel_models(config);
  for (const ModelConfig& model : models_of(config)) {
    const SensorEntry* entry = registry().sensor(model.type);
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

KINECAL_INLINE double reach_of(const Robot& robot, const RuntimeChain& chain) {
  double reach = chain.tail.translation.norm();
  for (const ChainJoint& joint : chain.joints) {
    reach += joint.fixed.translation.norm();
    if (joint.type != JointType::prismatic || !robot.has_joint(joint.name)) continue;
    const auto& limits = robot.joint(joint.name).limits;
    if (!limits) continue;
    const double travel = std::max(std::abs(limits->lower), std::abs(limits->upper));
    if (travel < 100.0) reach += travel;  // more stands for no limit
  }
  return reach;
}

/// Error: coordinates that cannot be meant.
/// @returns  true if there are any
inline bool report_absurd_points(const RecordedPoints& recorded, std::span<const Sample> samples,
                                 Diagnostics& diagnostics) {
  const double most = recorded.in_metres ? 1e5 : 1e6;  // metres, or pixels and readings
  Occurrences absurd;
  double first = 0.0;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const double size = recorded.points[i].cwiseAbs().maxCoeff();
    if (size <= most) continue;
    if (absurd.count == 0) first = size;
    if (absurd.count == 0 || absurd.first != recorded.samples[i]) absurd.add(recorded.samples[i]);
  }
  if (absurd.count == 0) return false;
  diagnostics.error(place_of(samples, absurd.first),
                    fmt::format("sensor '{}' has a feature with the number {:.6g}{}; correct or "
                                "remove the sample",
                                recorded.model.name, first, absurd.others()));
  return true;
}

/// How large the recorded points are: their distance from a sensor that moves, their extent for one
/// that does not, for a tracker may stand far away.
[[nodiscard]] inline double size_of(const RecordedPoints& recorded) {
  std::vector<double> sizes;
  Vector3<double> center = Vector3<double>::Zero();
  if (!recorded.moves) {
    for (const auto& point : recorded.points) center += point;
    center /= static_cast<double>(recorded.points.size());
  }
  for (const auto& point : recorded.points) sizes.push_back((point - center).norm());
  const auto at = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), at, sizes.end());
  return *at;  // half of the points are as large
}

/// Error or doubt: points further away than the robot is large.
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

/// Error or doubt: pixels that are none.
inline void check_pixels(const RecordedPoints& recorded, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  const Observation* seen = samples[recorded.samples.front()].observation(recorded.model.name);
  if (!seen->camera || seen->camera->width <= 0 || seen->camera->height <= 0) return;
  const double width = seen->camera->width, height = seen->camera->height;
  double most = 0.0;
  Occurrences outside;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    const double u = recorded.points[i].x(), v = recorded.points[i].y();
    most = std::max({most, std::abs(u), std::abs(v)});
    const bool is_outside =
        u < -0.1 * width || u > 1.1 * width || v < -0.1 * height || v > 1.1 * height;
    if (!is_outside || (outside.count > 0 && outside.first == recorded.samples[i])) continue;
    outside.add(recorded.samples[i]);
  }
  if (most < 4.0 && recorded.points.size() > 3) {
    diagnostics.error(
        place_of(samples, recorded.samples.front()),
        fmt::format("no feature of sensor '{}' is beyond {:.3g} pixels of an image of "
                    "{}x{}; they look like metres or normalized coordinates",
                    recorded.model.name, most, width, height));
  } else if (outside.count > 0) {
    diagnostics.doubt(
        place_of(samples, outside.first),
        fmt::format("a feature of sensor '{}' is outside its image of {}x{} pixels{}; "
                    "is it the camera_info of another camera or size?",
                    recorded.model.name, width, height, outside.others()));
  }
}

/// Error: a camera that records the same in every sample though the robot moves.
inline void check_frozen(const RecordedPoints& recorded, std::span<const Sample> samples,
                         Diagnostics& diagnostics) {
  const auto last = recorded.samples.back();
  if (!recorded.is_measured || !recorded.is_constant || recorded.samples.front() == last) return;
  if (samples[last].joint_positions == samples[recorded.samples.front()].joint_positions) return;
  diagnostics.error(
      place_of(samples, recorded.samples.front()),
      fmt::format("sensor '{}' records the same features, to the last digit, in every "
                  "sample though the robot moves; its driver or topic has stopped",
                  recorded.model.name));
}

KINECAL_INLINE void check_sensor_points(const Config& config, const Robot& robot,
                                        std::span<const Sample> samples, Diagnostics& diagnostics) {
  const std::vector<RecordedPoints> all = recorded_points(config, robot, samples);
  double reach = 0.0;
  for (const RecordedPoints& recorded : all) {
    reach = std::max(reach, reach_of(robot, recorded.chain));
  }
  for (const RecordedPoints& recorded : all) {
    if (report_absurd_points(recorded, samples, diagnostics)) continue;
    check_frozen(recorded, samples, diagnostics);
    const SensorEntry* entry = registry().sensor(recorded.model.type);
    if (recorded.in_metres) {
      check_distances(recorded, reach, samples, diagnostics);
    } else if (entry->sensor->delivers(Quantity::pixel)) {
      check_pixels(recorded, samples, diagnostics);
    }
  }
}

}  // namespace kinecal::detail
