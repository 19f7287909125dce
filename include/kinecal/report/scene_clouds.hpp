// The clouds of a scene's samples: what the camera saw, on the robot as it is believed to stand.
// Source: Fetch paper, figures 2 and 3.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/linkage.hpp"
#include "kinecal/report/robot_scene.hpp"

namespace kinecal {

/// Adds the clouds that recordings have of the samples of a scene, thinned: 60 000 points in all, 300 to
/// 5000 in a sample.  A cloud in a frame that is no link of the scene is left out.
/// @param files  of the samples, in any format
void add_clouds(const std::vector<std::string>& files, RobotScene& scene);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/report/scene_clouds.ipp"
#endif
