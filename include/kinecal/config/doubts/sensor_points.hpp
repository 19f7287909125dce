// Checks recorded points against the size of the robot: millimetres, frozen sensors, absurd
// numbers.
//
// A fixed sensor and the arm that it measures see the same points up to a rigid transform, so these
// spread alike about their mean, wherever the sensor is.  A moving sensor sees nothing much further
// away than the robot's size.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/chain.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// The points of a model in all samples.
struct RecordedPoints {
  ModelConfig model;
  RuntimeChain chain;        ///< from the base link to its frame
  bool moves = false;        ///< some joint of the chain moves
  bool is_measured = false;  ///< by a camera: has parameters, and never measures the same twice
  bool in_metres = false;    ///< features are points, not pixels
  bool is_constant = true;   ///< the same features in every sample
  std::vector<Vector3<double>> points;  ///< as recorded, without NaN
  std::vector<std::size_t> samples;     ///< index of the sample of each point
};

/// The recorded points of a configuration's models; skips models without points, or that do not
/// match the robot.
[[nodiscard]] std::vector<RecordedPoints> recorded_points(const Config& config, const Robot& robot,
                                                          std::span<const Sample> samples);

/// Root mean square distance of points from their center, without the farthest tenth, metres.
[[nodiscard]] double spread_of(std::span<const Vector3<double>> points);

/// Sum of the lengths of a chain's links and the travel of its sliding joints, metres.
[[nodiscard]] double reach_of(const Robot& robot, const RuntimeChain& chain);

/// Error: absurd numbers, points in millimetres or kilometres, features that are not pixels, a
/// camera that always records the same.  Doubt: points far away, intrinsics of another image.
void check_sensor_points(const Config& config, const Robot& robot, std::span<const Sample> samples,
                         Diagnostics& diagnostics);

/// Error or doubt: an arm's points and those of a fixed sensor spread differently.  Doubt: they agree with the URDF to a
/// rounding error, because a controller computed them from the joints.
void check_spreads(const Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics);

}  // namespace kinecal::detail
