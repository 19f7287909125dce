// What sensors recorded against the size of the robot: millimetres, frozen sensors, absurd numbers.
//
// A sensor that does not move and an arm that it measures see the same points but for a rigid
// transform, so these spread alike about their mean, wherever the sensor is.  A sensor that moves
// sees nothing much further away than the robot is large.
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
#include "kinecal/linkage.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// What a model recorded in all samples.
struct RecordedPoints {
  ModelConfig model;
  RuntimeChain chain;        ///< from the base link to its frame
  bool moves = false;        ///< a joint of the chain moves
  bool is_measured = false;  ///< by a camera: with parameters of its own, never twice the same
  bool in_metres = false;    ///< features are points, not pixels
  bool is_constant = true;   ///< the same features in every sample
  std::vector<Vector3<double>> points;  ///< as recorded; those that are numbers
  std::vector<std::size_t> samples;     ///< index of the sample of each point
};

/// What the models of a configuration recorded; models without any points, or that do not fit the
/// robot, are left out.
[[nodiscard]] std::vector<RecordedPoints> recorded_points(const Config& config, const Robot& robot,
                                                          std::span<const Sample> samples);

/// Root of the mean squared distance of points to their center, without the farthest tenth, metres.
[[nodiscard]] double spread_of(std::span<const Vector3<double>> points);

/// Sum of the lengths of a chain's links and the travel of its sliding joints, metres.
[[nodiscard]] double reach_of(const Robot& robot, const RuntimeChain& chain);

/// Error: numbers that cannot be meant, points in millimetres or kilometres, pixels that are not
/// pixels, a camera that always records the same.  Doubt: points far away, intrinsics of another image.
void check_sensor_points(const Config& config, const Robot& robot, std::span<const Sample> samples,
                         Diagnostics& diagnostics);

/// Error or doubt: an arm's points and those of a sensor that does not move spread differently.
void check_spreads(const Config& config, const Robot& robot, std::span<const Sample> samples,
                   Diagnostics& diagnostics);

}  // namespace kinecal::detail

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/config/doubts/sensor_points.ipp"
#endif
