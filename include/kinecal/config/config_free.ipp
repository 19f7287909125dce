// Reads free parameters and frames of a configuration, their initial values and bounds.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/config/config_items.ipp"
#include "kinecal/geometry/rpy.hpp"

namespace kinecal::detail {

inline constexpr std::array<const char*, 6> kConfigAxes = {"x", "y", "z", "roll", "pitch", "yaw"};

/// Frames, and which of their axes are free in one or more steps.
using FreeAxes = std::map<std::string, std::array<bool, 6>>;

inline void read_free_params(ConfigMap& map, StepConfig& step) {
  for (const ConfigEntry& element : map.list("free_params")) {
    if (const auto name = config_text(element.value)) {
      step.free_params.push_back({*name, element.place});
    } else {
      map.error(element.place,
                "free_params: " + describe_config(element.value) + " is not a name of a parameter");
    }
  }
}

/// Frees a parameter once that is freed twice, by its name or as an axis of a frame; a warning.
inline void check_free_parameters(const ConfigMap& map, StepConfig& step) {
  std::map<std::string, SourceLocation> places;
  for (const FreeFrameConfig& frame : step.free_frames) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (frame.axes[i]) places.emplace(parameter_name(frame.name, kFrameAxes[i]), frame.place);
    }
  }
  std::erase_if(step.free_params, [&](const FreeParamConfig& parameter) {
    const auto [other, is_new] = places.emplace(parameter.name, parameter.place);
    if (is_new) return false;
    map.warning(parameter.place, "free parameter '" + parameter.name +
                                     "' occurs twice and counts once; the other is in line " +
                                     std::to_string(other->second.line));
    return true;
  });
}

/// Warns of a frame without a free axis.
inline void check_free_axes(const ConfigMap& map, const FreeFrameConfig& frame) {
  if (std::find(frame.axes.begin(), frame.axes.end(), true) == frame.axes.end()) {
    map.warning(frame.place, "no axis is free");
  }
}

[[nodiscard]] inline FreeFrameConfig read_free_frame(ConfigItem& item) {
  FreeFrameConfig frame{item.name, {}, item.place};
  if (!item.map) return frame;
  for (std::size_t i = 0; i < 6; ++i) frame.axes[i] = item.map->flag(kConfigAxes[i], false);
  check_free_axes(*item.map, frame);
  item.map->report_unknown();
  return frame;
}

/// The pose of a frame from its keys x y z roll pitch yaw, zero by default.
[[nodiscard]] inline FrameInitialValueConfig read_frame_pose(ConfigItem& item) {
  FrameInitialValueConfig pose;
  pose.name = item.name;
  pose.place = item.place;
  if (!item.map) return pose;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    (i < 3 ? pose.xyz : pose.rpy)(axis) = item.map->number(kConfigAxes[i], 0.0);
  }
  item.map->report_unknown();
  return pose;
}

/// `fixed_frames:`  a frame of features, beyond the link of their model, with a known pose: a
/// virtual frame without free axes.
/// @return  the values of its parameters
[[nodiscard]] inline std::vector<InitialValueConfig> read_fixed_frame(ConfigItem& item,
                                                                      StepConfig& step) {
  const FrameInitialValueConfig pose = read_frame_pose(item);
  const auto same = [&](const FreeFrameConfig& frame) { return frame.name == pose.name; };
  if (std::any_of(step.free_frames.begin(), step.free_frames.end(), same) && item.map) {
    item.map->error(item.place, "is one of free_frames, too; list it once");
  }
  step.free_frames.push_back({pose.name, {}, pose.place, true});
  Eigen::Matrix<double, 6, 1> values;
  values << pose.xyz, log(rotation_from_rpy(pose.rpy));
  std::vector<InitialValueConfig> all;
  for (std::size_t i = 0; i < 6; ++i) {
    all.push_back({parameter_name(pose.name, kFrameAxes[i]), values(static_cast<Eigen::Index>(i)),
                   pose.place});
  }
  return all;
}

/// Warns of an initial value along axes that are not free.  The axes of a rotation are the
/// components of its rotation vector, as for free parameters.
inline void check_initial_axes(const ConfigMap& map, const FrameInitialValueConfig& initial,
                               const std::array<bool, 6>& free) {
  constexpr double kZero = 1e-12;  // rounding of a rotation vector
  const Vector3<double> rotation = log(rotation_from_rpy(initial.rpy));
  for (std::size_t i = 0; i < 6; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const double value = i < 3 ? initial.xyz(axis) : rotation(axis);
    if (free[i] || std::abs(value) <= (i < 3 ? 0.0 : kZero)) continue;
    map.warning(initial.place, std::string(kConfigAxes[i]) +
                                   " is not free: its initial value is ignored, as "
                                   "robot_calibration does");
  }
}

/// @param free  the axes that are free in this step or a previous one
[[nodiscard]] inline FrameInitialValueConfig read_frame_initial_value(ConfigItem& item,
                                                                      const FreeAxes& free) {
  FrameInitialValueConfig initial = read_frame_pose(item);
  if (!item.map) return initial;
  if (const auto frame = free.find(item.name); frame != free.end()) {
    check_initial_axes(*item.map, initial, frame->second);
  }
  return initial;  // a frame that is not free: assemble() knows whether the robot has it
}

/// `initial_values: {parameter: number}`
[[nodiscard]] inline std::vector<InitialValueConfig> read_initial_values(ConfigMap& map) {
  std::vector<InitialValueConfig> values;
  auto entries = map.map("initial_values", "initial_values");
  if (!entries) return values;
  for (const ConfigEntry& entry : entries->entries()) {
    values.push_back({entry.key, entries->number(entry.key, 0.0), entry.place});
  }
  return values;
}

/// `bounds: {parameter: [lower, upper]}`; a bound may be .inf or -.inf
[[nodiscard]] inline std::vector<BoundConfig> read_bounds(ConfigMap& map) {
  std::vector<BoundConfig> bounds;
  auto entries = map.map("bounds", "bounds");
  if (!entries) return bounds;
  for (const ConfigEntry& entry : entries->entries()) {
    std::vector<double> limits;
    for (const ConfigEntry& element : entries->list(entry.key)) {
      if (const auto limit = config_number(element.value)) limits.push_back(*limit);
    }
    const bool is_pair =
        entry.value.is_list() && entry.value.items.size() == 2 && limits.size() == 2;
    if (is_pair && limits[0] < limits[1]) {
      bounds.push_back({entry.key, limits[0], limits[1], entry.place});
    } else if (is_pair) {
      entries->error(entry.place, entry.key + ": the lower bound " + number_to_yaml(limits[0]) +
                                      " is not below the upper bound " + number_to_yaml(limits[1]));
    } else if (entry.value.is_list()) {
      entries->error(entry.place, entry.key + " is not a list of two numbers, [lower, upper]");
    }
  }
  return bounds;
}

/// Reports bounds of parameters that are not free, and drops them, so that one mistake gives one
/// message.
/// @param free   names of the free parameters
/// @param where  where they would be free, for the message: "in this step"
inline void check_bounds(const ConfigMap& map, std::vector<BoundConfig>& bounds,
                         const std::vector<std::string>& free, const std::string& where) {
  std::erase_if(bounds, [&](const BoundConfig& bound) {
    if (std::find(free.begin(), free.end(), bound.name) != free.end()) return false;
    map.error(bound.place, "bounds: '" + bound.name + "' is not free " + where +
                               map.did_you_mean(bound.name, free));
    return true;
  });
}

}  // namespace kinecal::detail
