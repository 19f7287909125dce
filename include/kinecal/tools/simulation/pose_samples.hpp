// Predicted samples of poses that nobody has captured: the position of a simulated target, and
// roughly where the camera sees it according to the URDF.  Studies make them exact: see
// study/exact_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal {

/// Samples of poses.
struct PoseSamples {
  std::vector<Sample> samples;       ///< of the poses in which the camera sees the target
  std::vector<std::size_t> poses;    ///< index of the pose of each of them
  std::vector<std::string> skipped;  ///< "poses.yaml:3: the target is behind the camera"
  /// Values of parameters in which the URDF's robot differs from a configuration: the pose of the
  /// target, if the configuration has a frame for it.
  ParameterTable values;
};

/// A pose at rest, as a sample without observations.
/// @param pose  unnamed joints are at zero, or at the nearest limit
[[nodiscard]] Sample sample_in_pose(const Robot& robot, const CapturePose& pose);

/// The samples for an error block between a camera and the chain with the target.
/// @param plan   with its camera and its target
/// @param poses  unnamed joints are at zero, or at the nearest limit
/// @throws InputError  if the configuration has no error block between a camera and a chain that
///                     holds the target, or if the target has no points
[[nodiscard]] PoseSamples pose_samples(const SimulationPlan& plan, const Config& config,
                                       const std::vector<CapturePose>& poses);

}  // namespace kinecal
