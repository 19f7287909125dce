// A scale of points that free lengths absorb: the fit is as good, but all lengths change by one factor.
//
//   Q(s) = sum over lengths of ((d + s v) / u)^2        u^2 = (1.5 mm)^2 + (3 +-)^2
//
// with d the change of a length by the calibration, and v what it changes by if points are multiplied by 1 + s:
// by a solve with slightly larger points.  Robots are built to a millimetre or so, each length wrong in its own
// way; so a factor that undoes nearly all of the change is no accident.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/explain/scale.ipp"
#include "kinecal/parameters/joint_models.hpp"
#include "kinecal/trust/assess.hpp"

namespace kinecal::detail {

/// A free length of the robot that the samples determine.
struct FreeLength {
  std::string name;        ///< of the parameter
  double change = 0.0;     ///< by the calibration, metres
  double deviation = 0.0;  ///< of the parameter, metres
};

/// The translations of joints that have a place in the URDF.
[[nodiscard]] inline std::vector<FreeLength> free_lengths(const Robot& robot,
                                                          const ParameterTable& solution,
                                                          const Assessment& step) {
  std::vector<FreeLength> lengths;
  for (const Joint& joint : robot.joints()) {
    if (joint.origin.translation.isZero()) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int p = solution.find(parameter_name(joint.name, kFrameAxes[axis]));
      if (p < 0) continue;
      const std::optional<double> deviation = step.deviation(p);
      if (!deviation || !std::isfinite(*deviation)) continue;
      lengths.push_back({solution[p].name, solution[p].value - solution[p].initial, *deviation});
    }
  }
  return lengths;
}

/// A configuration that frees the zeros of all joints in place of lengths and joint models.  Whole frames are
/// mounts and stay.
[[nodiscard]] inline Config with_zeros_for_lengths(Config config, const Robot& robot) {
  for (StepConfig& step : config.steps) {
    std::erase_if(step.free_frames, [&](const FreeFrameConfig& frame) {
      const auto is_held = [](bool free) { return !free; };
      return robot.has_joint(frame.name) && moves(robot.joint(frame.name).type) &&
             std::any_of(frame.axes.begin(), frame.axes.end(), is_held);
    });
    std::erase_if(step.free_params, [&](const FreeParamConfig& free) {
      return robot.has_joint(free.name) || joint_model_parameter(robot, free.name);
    });
    for (const Joint* joint : joints_between(config, robot)) {
      if (moves(joint->type) && !joint->mimic)
        step.free_params.push_back({joint->name, step.place});
    }
  }
  return config;
}

/// The root of the mean squared change of lengths, metres.
[[nodiscard]] inline double mean_change(const std::vector<FreeLength>& lengths,
                                        const ParameterTable& solution) {
  double squares = 0.0;
  for (const FreeLength& length : lengths) {
    const Parameter& p = solution[length.name];
    squares += (p.value - p.initial) * (p.value - p.initial);
  }
  return std::sqrt(squares / static_cast<double>(lengths.size()));
}

/// The factor of points that undoes nearly all changes of lengths, as a sentence; nullopt if none does.
[[nodiscard]] inline std::optional<std::string> absorbed_scale(
    const Refits& refits, const Suspect& suspect, const Refit& now,
    const std::vector<FreeLength>& lengths) {
  constexpr double kStep = 0.005;
  const auto scaled = refits.with(with_scaled(refits, suspect, 1.0 + kStep));
  if (!scaled) return std::nullopt;
  constexpr double kBuilt = 1.5e-3, kWide = 3.0;  // metres; deviations
  double before = 0.0, slope = 0.0, curvature = 0.0, least_moved = 0.0;
  std::vector<double> moves;
  for (const FreeLength& length : lengths) {
    const double v = (scaled->table[length.name].value - now.table[length.name].value) / kStep;
    const double u = std::hypot(kBuilt, kWide * length.deviation);
    before += length.change * length.change / (u * u);
    slope += length.change * v / (u * u);
    curvature += v * v / (u * u);
    moves.push_back(v / u);
  }
  if (!(curvature > 0.0)) return std::nullopt;
  const double s = -slope / curvature, gain = slope * slope / curvature;
  for (const double move : moves) least_moved = std::max(least_moved, move * move);
  constexpr double kSure = 16.0, kExplained = 0.8, kOfOne = 0.85, kFurthest = 0.6;
  if (gain < kSure || gain < kExplained * before || least_moved > kOfOne * curvature ||
      std::abs(s) > kFurthest) {
    return std::nullopt;
  }
  constexpr double kAsGood = 1.3;
  const auto then = refits.with(with_scaled(refits, suspect, 1.0 + s));
  if (!then || then->cost > kAsGood * now.cost) return std::nullopt;
  return fmt::format(
      "{}multiplied by {:.4g}, the lengths of the robot change by {:.2g} mm (RMS) in place of "
      "{:.2g} "
      "mm, and the samples fit as well",
      suspect.undone, 1.0 + s, 1e3 * mean_change(lengths, then->table),
      1e3 * mean_change(lengths, now.table));
}

}  // namespace kinecal::detail
