// Rounds that leave out the background of clouds which error blocks compare with a sphere, a plane or a line: the table under a ball
// in the profiles of a line scanner, what stands before the wall that a laser sees.
//
// A block whose sensor sees clouds (point_to_sphere, chain3d_to_plane, point_on_plane, point_to_line, point_on_line; more than ten
// points a sample, without ids) takes part if it has a loss of which far points hardly count, cauchy or tukey.
//
// 1. Each round is a calibration, the first with a loss of 81 times that scale, then narrower by a factor of three, from where the
//    round before ended.  So no guess has to say which points belong.
// 2. What is then beyond four robust standard deviations of the points, at most five scales, is of something else: it is left out, and
//    the solve has the others with their loss.
//
// The meshes of a robot, a room or a plate are matched by surface_rounds.hpp.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal {

/// True if an error block compares clouds that may have a background.
[[nodiscard]] bool has_background(const Config& config, std::span<const Sample> samples);

/// Leaves the background out.
/// @param held     values by name, where nothing is to be solved; others have their initial values.  Nullopt: rounds find them
/// @param config   blocks without a sigma get the noise of their points
/// @param samples  lose points
/// @param diagnostics  errors: clouds that are not of what they are compared with; doubts: the same where values are held;
///                     notes: how many points count; warnings: samples without any
/// @returns  where the rounds ended, of all parameters of the assembled table; empty after an error, or where values are held
std::vector<double> leave_out_background(const Robot& robot,
                                         const std::optional<std::map<std::string, double>>& held,
                                         Config& config, std::vector<Sample>& samples,
                                         const SolveOptions& solving, Diagnostics& diagnostics);

/// Begins where rounds ended: initial values and searches for poses have done their work.
void begin_at(std::vector<double> values, Calibration& calibration);

}  // namespace kinecal
