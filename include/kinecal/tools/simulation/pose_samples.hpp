// Samples of poses in which nobody has captured yet: where a simulated target is, and about where the
// camera sees it by the URDF.  Studies make exact ones of them: see study/exact_samples.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/capture/capture_pose.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/linkage.hpp"
#include "kinecal/tools/simulation/simulation_plan.hpp"

namespace kinecal {

/// Samples of poses.
struct PoseSamples {
  std::vector<Sample> samples;       ///< of the poses in which the camera sees the target
  std::vector<std::size_t> poses;    ///< index of the pose of each of them
  std::vector<std::string> skipped;  ///< "poses.yaml:3: the target is behind the camera"
  /// Values of parameters by which the robot of the URDF differs from a configuration: where the target
  /// is, if the configuration has a frame for it.
  ParameterTable values;
};

/// The samples that an error block between a camera and the chain with the target takes.
/// @param plan   with its camera and its target
/// @param poses  joints that a pose does not name are at zero, or at their limit next to it
/// @throws InputError  if the configuration compares no camera with a chain that holds the target, or
///                     for a target without points
[[nodiscard]] PoseSamples pose_samples(const SimulationPlan& plan, const Config& config,
                                       const std::vector<CapturePose>& poses);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/tools/simulation/pose_samples.ipp"
#endif
