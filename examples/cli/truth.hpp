// Judging a calibration of a simulated robot by the truth.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/procedure/session_follower.hpp"

namespace kinecal::cli {

/// How far the pose of the gripper in the camera's frame is from the truth, by the URDF and after the
/// calibration, over the poses of the samples; as a line to print, empty if nothing is compared.
/// @param scene  of the simulation: see read_simulation()
[[nodiscard]] std::string truth_text(const Robot& robot, const std::string& scene,
                                     const CalibratedRobot& all);

}  // namespace kinecal::cli
