// Warnings about samples that are probably unintended.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/sensors/any_sensor.hpp"
#include "kinecal/text/nearest_name.hpp"

namespace kinecal::detail {

/// Names of the models whose sensors are of some kind.
/// @param is_meant  predicate on an AnySensor
template <class IsMeant>
[[nodiscard]] std::set<std::string> models_where(const Config& config, const IsMeant& is_meant) {
  std::set<std::string> names;
  for (const StepConfig& step : config.steps) {
    for (const ModelConfig& model : step.models) {
      const SensorEntry* entry = entry_of(model);
      if (entry != nullptr && is_meant(*entry->sensor)) names.insert(model.name);
    }
  }
  return names;
}

/// Warns of NaN features, once for all steps.
inline void warn_of_unusable(const Config& config, std::span<const Sample> samples,
                             Diagnostics& diagnostics) {
  const std::set<std::string> oriented =
      models_where(config, [](const AnySensor& sensor) { return sensor.is_oriented(); });
  std::size_t unusable = 0;
  std::string first;
  for (const Sample& sample : samples) {
    for (const Observation& observation : sample.observations) {
      for (const Feature& feature : observation.features) {
        const bool turned = feature.rotation && oriented.contains(observation.sensor);
        if (feature.point.allFinite() && (!turned || feature.rotation->allFinite())) continue;
        if (unusable++ == 0) first = sample.source + ", sensor '" + observation.sensor + "'";
      }
    }
  }
  if (unusable == 0) return;
  diagnostics.warnings.push_back(
      fmt::format("{} {} and left out; the first is at {}", unusable,
                  unusable == 1 ? "feature is not a number" : "features are not numbers", first));
}

/// Warns of points farther away than any calibration target: the unit or the capture is probably
/// wrong.
inline void warn_of_far_points(const Config& config, std::span<const Sample> samples,
                               Diagnostics& diagnostics) {
  constexpr double kFar = 100.0;
  const std::set<std::string> in_metres = models_where(
      config, [](const AnySensor& sensor) { return sensor.delivers(Quantity::point); });
  std::size_t count = 0;
  std::string first;
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (!in_metres.contains(seen.sensor)) continue;
      for (const Feature& feature : seen.features) {
        const double distance = feature.point.norm();
        if (!(std::isfinite(distance) && distance > kFar)) continue;
        if (count++ > 0) continue;
        first = fmt::format("{}, sensor '{}', {:.0f} m", sample.source, seen.sensor, distance);
      }
    }
  }
  if (count == 0) return;
  diagnostics.warnings.push_back(
      fmt::format("{} point{} more than {:.0f} m away from their frame; are they in metres?  "
                  "The first is at {}",
                  count, count == 1 ? " is" : "s are", kFar, first));
}

/// Warns of cameras whose camera_info changes: the output files start from the first one.
inline void warn_of_changing_cameras(std::span<const Sample> samples, Diagnostics& diagnostics) {
  std::map<std::string, std::pair<const CameraInfo*, bool>> first;  // true if already reported
  for (const Sample& sample : samples) {
    for (const Observation& seen : sample.observations) {
      if (!seen.camera) continue;
      auto& [info, reported] = first.try_emplace(seen.sensor, &*seen.camera, false).first->second;
      const CameraInfo& now = *seen.camera;
      const bool same = info->p == now.p && info->k == now.k && info->d == now.d &&
                        info->z_offset == now.z_offset && info->z_scaling == now.z_scaling;
      if (same || reported) continue;
      reported = true;
      diagnostics.warnings.push_back(
          fmt::format("{}: the camera_info of sensor '{}' differs from that of the first sample, "
                      "which the written camera files are made from",
                      sample.source, seen.sensor));
    }
  }
}

/// Indices of repeated names, each with the first one of the same name.
[[nodiscard]] inline std::vector<std::pair<std::size_t, std::size_t>> repeated(
    const std::vector<std::string>& names) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  std::map<std::string_view, std::size_t> first;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [known, is_new] = first.emplace(names[i], i);
    if (!is_new) pairs.emplace_back(known->second, i);
  }
  return pairs;
}

/// Warns of joints that a sample names twice with different positions.  robot_calibration records a
/// joint once per chain that moves it.
inline void warn_of_joints_with_two_positions(std::span<const Sample> samples,
                                              Diagnostics& diagnostics) {
  constexpr double kSame = 1e-9;  // far below what an encoder resolves
  std::size_t count = 0;
  std::string first;
  const std::vector<std::string>* names = nullptr;  // of the previous sample: most have the same
  std::vector<std::pair<std::size_t, std::size_t>>
      twice;  // indices of a name and of its repetition
  for (const Sample& sample : samples) {
    if (sample.joint_names.size() != sample.joint_positions.size()) continue;  // that is an error
    if (names == nullptr || *names != sample.joint_names) {
      names = &sample.joint_names;
      twice = repeated(*names);
    }
    for (const auto& [i, again] : twice) {
      const double taken = sample.joint_positions[i], position = sample.joint_positions[again];
      if (std::abs(position - taken) <= kSame) continue;
      if (count++ > 0) continue;
      first =
          fmt::format("{}, joint '{}' at {} and {}", sample.source, (*names)[i], taken, position);
    }
  }
  if (count == 0) return;
  diagnostics.warnings.push_back(fmt::format(
      "{} joint{} of a sample {} a second position that differs; the first one is used.  "
      "The first is at {}",
      count, count == 1 ? "" : "s", count == 1 ? "has" : "have", first));
}

}  // namespace kinecal::detail
