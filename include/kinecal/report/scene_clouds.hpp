// Point clouds of a scene's samples: the camera's view, at the believed pose of the robot.
// Source: Fetch paper, figures 2 and 3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// Adds the recorded clouds of a scene's samples, thinned to 60 000 points in all, 300 to 5000 per
/// sample.  Skips a cloud in a frame that is not a link of the scene, and samples whose points are compared with the
/// surface of the robot: they have their own colours.
/// @param files  of the samples, in any format
void add_clouds(const std::vector<std::string>& files, RobotScene& scene);

}  // namespace kinecal
