// Pictures of a calibration: the robot, its samples, and the measured points.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/procedure/calibrate_robot.hpp"

namespace kinecal::cli {

/// Writes the scene for Foxglove and Lichtblick: MCAP.
/// @throws OutputError  naming the file
void write_scene_file(const std::string& file, const CalibratedRobot& calibrated,
                      const std::vector<std::string>& mesh_paths);

}  // namespace kinecal::cli
