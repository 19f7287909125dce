// Pictures of a calibration: the robot, its samples, and the measured points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/procedure/calibrate_robot.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal::cli {

/// The scene of a calibration, with the meshes found; prints warnings about the others.
/// @param mesh_paths  further folders of packages, besides the environment and the URDF's folder
[[nodiscard]] RobotScene scene_of(const CalibratedRobot& calibrated,
                                  const std::vector<std::string>& mesh_paths,
                                  const SceneLimits& limits = {});

/// Writes the scene for Foxglove and Lichtblick: MCAP.
/// @throws OutputError  naming the file
void write_scene_file(const std::string& file, const CalibratedRobot& calibrated,
                      const std::vector<std::string>& mesh_paths);

}  // namespace kinecal::cli
