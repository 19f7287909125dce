// What a camera would see of the robot's own surface in poses that nobody has captured: points of it, or of its outline, each
// with the place on its link that it is of.  So nothing has to be associated, and studies know what each pose would show.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "kinecal/capture/session/capture_pose.hpp"
#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/procedure/surface_blocks.hpp"
#include "kinecal/study/simulated_camera.hpp"
#include "kinecal/tools/simulation/pose_samples.hpp"

namespace kinecal {

/// Points of the surface, or of its outline, in a sample of a study, at most.
inline constexpr int kViewPoints = 300;

/// Samples of poses, without noise, with the robot and its camera where the configuration puts them.
/// @param camera  of the models that look at the robot: its image, and the depths that it measures
/// @param config  gets the links of the surface
/// @param poses   unnamed joints are at zero, or at the nearest limit
/// @param diagnostics  errors: meshes that are missing, a block that compares anything else
/// @returns  empty after an error
[[nodiscard]] PoseSamples surface_views(const SurfaceInput& input, const SimulatedCamera& camera,
                                        Config& config, std::span<const CapturePose> poses,
                                        Diagnostics& diagnostics);

/// Samples of a calibration for a study: of the features of each block of the surface those that lie on it, at most
/// kViewPoints, evenly.  Background near the robot says nothing of its pose.
/// @param problem  with these samples, associated
/// @param values   of all parameters of its table
/// @param blocks   names of the blocks of the surface
[[nodiscard]] std::vector<Sample> surface_points(const AnyProblem& problem, ParameterValues values,
                                                 std::span<const std::string> blocks,
                                                 std::span<const Sample> samples);

}  // namespace kinecal
