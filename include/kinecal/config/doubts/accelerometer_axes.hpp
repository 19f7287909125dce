// Accelerometers with another sign or other axes than assumed: a reading at rest points up, as sensor_msgs/Imu has it.
//
//   a = s Q R^T up      R the axes of the sensor in the base, by the URDF and the joints, s the strength
//
// Where the URDF has the sensor's link, Q should be the identity; of the 48 matrices that exchange and reverse axes, the best
// is named.  Elsewhere its rotation is found anyway, but no rotation is a reflection: det sum(R^T up a^T) < 0.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kinecal/config/config.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/kinematics/robot.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal::detail {

/// Adds doubts.
void check_accelerometer_axes(const Config& config, const Robot& robot,
                              std::span<const Sample> samples, Diagnostics& diagnostics);

}  // namespace kinecal::detail
