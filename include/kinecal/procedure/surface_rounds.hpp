// Rounds of association for calibrations that compare points with the surface of the robot (chain3d_to_mesh).
//
// 1. The meshes of the URDF become the links of the sensor that stands for the surface.
// 2. Coarse rounds on a few points: nearest points of the surface, a step, and again with a narrower gate.  Where the pose
//    of a camera is unknown, or the start ends badly, poses are searched for first (surface/pose_search.hpp).
// 3. Fine rounds on all points with the loss of the configuration: Levenberg-Marquardt on the true distances, until cost
//    and associations settle.  Without a loss, points beyond four robust sigmas (at least kNarrowest) count as strangers.
// 4. The samples get the nearest points as an ordinary observation; points beyond the gate are left out.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/procedure/surface_blocks.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// True if an error block compares clouds or masks with the surface of the robot.
[[nodiscard]] bool compares_surface(const Config& config);

/// Associates the points of all samples with the surface of the robot.
/// @param config   gets the links of the surface
/// @param samples  get the observation of the surface; points that are not of the robot are left out
/// @param diagnostics  errors: meshes that are missing, clouds that do not lie on the robot; notes: the fit
/// @returns  where the rounds ended, of all parameters of the assembled table; empty after an error
[[nodiscard]] std::vector<double> match_surface(const SurfaceInput& input, Config& config,
                                                std::vector<Sample>& samples,
                                                Diagnostics& diagnostics);

/// The same with the robot and its cameras where given values put them: nothing is solved.  Where rounds have found a gate
/// before (SurfaceConfig::gate), it stays.
/// @param blocks  read_surface_blocks() of the configuration
/// @param values  by name; other parameters have their initial values
/// @param diagnostics  errors: clouds that cannot be in metres; doubts: clouds and masks that do not lie on the robot there;
///                     notes: how they lie on it
void match_surface_at(const SurfaceInput& input, std::vector<std::vector<SurfaceBlock>> blocks,
                      const std::map<std::string, double>& values, Config& config,
                      std::vector<Sample>& samples, Diagnostics& diagnostics);

}  // namespace kinecal
