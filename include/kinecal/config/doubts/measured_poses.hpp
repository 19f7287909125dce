// Checks the measured poses of floating joints: whether they turn enough to find what is fixed to them.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Doubt: the poses of a floating joint do not turn, or all turn about one axis: a frame on the
/// moving side then has places that no sample tells apart.
/// Source: Tsai, Lenz, A New Technique for Fully Autonomous and Efficient 3D Robotics Hand/Eye
/// Calibration, 1989: two rotations about axes that are not parallel.
void check_measured_poses(const Config& config, const Robot& robot, std::span<const Sample> samples,
                          Diagnostics& diagnostics);

}  // namespace kinecal::detail
