// Compares how points spread about their center: those of a fixed sensor, and those of the arm.
// Uses the median and drops the farthest tenth, so that a few distant points do not decide.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>
#include <vector>

#include "kinecal/config/doubts/occurrences.hpp"
#include "kinecal/config/doubts/sensor_points.hpp"
#include "kinecal/config/doubts/used_joints.hpp"
#include "kinecal/config/registry.hpp"
#include "kinecal/geometry/median.hpp"
#include "kinecal/kinematics/forward_kinematics.hpp"

namespace kinecal::detail {

double spread_of(std::span<const Vector3<double>> points) {
  if (points.empty()) return 0.0;
  Vector3<double> center;
  std::vector<double> numbers(points.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::transform(points.begin(), points.end(), numbers.begin(),
                   [axis](const auto& point) { return point(axis); });
    center(axis) = median_of(numbers);
  }
  std::transform(points.begin(), points.end(), numbers.begin(),
                 [&](const auto& point) { return (point - center).squaredNorm(); });
  std::sort(numbers.begin(), numbers.end());
  const std::size_t near = numbers.size() - (numbers.size() + 9) / 10;
  const double sum =
      std::accumulate(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(near), 0.0);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, near)));
}

/// Keeps the points of samples in which the other model has points, too.
[[nodiscard]] inline RecordedPoints together_with(const RecordedPoints& other,
                                                  const RecordedPoints& all) {
  RecordedPoints kept = all;
  kept.points.clear();
  kept.samples.clear();
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (!std::binary_search(other.samples.begin(), other.samples.end(), all.samples[i])) continue;
    kept.points.push_back(all.points[i]);
    kept.samples.push_back(all.samples[i]);
  }
  return kept;
}

/// The points of a moving model in the base, for the robot of the URDF.
[[nodiscard]] inline std::vector<Vector3<double>> points_in_base(const RecordedPoints& recorded,
                                                                 std::span<const Sample> samples) {
  std::vector<Vector3<double>> points;
  Pose<double> base_T_sensor;
  for (std::size_t i = 0; i < recorded.points.size(); ++i) {
    if (i == 0 || recorded.samples[i] != recorded.samples[i - 1]) {
      base_T_sensor = forward_kinematics(recorded.chain, [&](const std::string& joint) {
        return samples[recorded.samples[i]].position(joint).value_or(0.0);
      });
    }
    points.push_back(base_T_sensor * recorded.points[i]);
  }
  return points;
}

/// The unit mistake that explains a factor between lengths; empty if none does.
[[nodiscard]] inline std::string unit_of_factor(double factor) {
  struct Unit {
    double factor;
    const char* name;
  };
  constexpr Unit kUnits[] = {{1000.0, "millimetres"},
                             {100.0, "centimetres"},
                             {39.37, "inches"},
                             {3.281, "feet"},
                             {0.001, "kilometres"}};
  for (const Unit& unit : kUnits) {
    if (std::abs(std::log(factor / unit.factor)) < std::log(1.3)) return unit.name;
  }
  return {};
}

/// Error or doubt: the two spreads differ.
/// @param fixed  of a sensor that does not move; @param arm  of one that moves
inline void compare_spreads(const RecordedPoints& fixed, const RecordedPoints& arm,
                            std::span<const Sample> samples, double reach,
                            Diagnostics& diagnostics) {
  const double of_fixed = spread_of(fixed.points), of_arm = spread_of(points_in_base(arm, samples));
  const double least = std::max(0.15, 0.1 * reach);  // metres: errors of zeros move less
  const double factor = of_fixed / std::max(of_arm, 1e-9);
  if (std::abs(of_fixed - of_arm) <= least || (factor > 1.0 / 3.0 && factor < 3.0)) return;
  const SourceLocation place = place_of(samples, fixed.samples.front());
  const std::string text = fmt::format(
      "points of '{}' move over {:.3g} m (rms about their center), those of sensor '{}' "
      "over {:.3g} m",
      arm.model.name, of_arm, fixed.model.name, of_fixed);
  const std::string unit = unit_of_factor(factor);
  if (fixed.is_constant) {
    diagnostics.error(
        place,
        text + fmt::format("; it records the same features in every sample though the robot "
                           "moves: its driver or topic has stopped, or the frames of '{}' and "
                           "'{}' are exchanged in the configuration",
                           arm.model.name, fixed.model.name));
  } else if (!unit.empty()) {
    diagnostics.error(place,
                      text + fmt::format("; they look like {}; points must be in metres", unit));
  } else {
    diagnostics.doubt(place, text + "; is it the right sensor, frame and unit?");
  }
}

void check_spreads(const Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics) {
  const std::vector<RecordedPoints> all = recorded_points(config, robot, samples);
  std::set<std::pair<const RecordedPoints*, const RecordedPoints*>> compared;
  for (const StepConfig& step : config.steps) {
    for (const BlockConfig& block : step.error_blocks) {
      const BlockEntry* entry = entry_of(block);
      if (entry == nullptr || entry->read_as != PointToPoint::kType) continue;
      std::vector<const RecordedPoints*> of_block;
      for (const std::string& model : block.models) {
        for (const RecordedPoints& recorded : all) {
          if (recorded.model.name == model && recorded.in_metres) of_block.push_back(&recorded);
        }
      }
      if (of_block.size() != 2 || of_block[0]->moves == of_block[1]->moves) continue;
      const RecordedPoints* fixed = of_block[of_block[0]->moves ? 1 : 0];
      const RecordedPoints* arm = of_block[of_block[0]->moves ? 0 : 1];
      // The view of a moving camera depends on its mount, which may be unknown.
      if (!arm->model.type.starts_with("chain")) continue;
      if (!compared.insert({fixed, arm}).second || fixed->points.size() < 3) continue;
      compare_spreads(together_with(*arm, *fixed), together_with(*fixed, *arm), samples,
                      reach_of(robot, arm->chain), diagnostics);
    }
  }
}

}  // namespace kinecal::detail
