// Gravity as an accelerometer on an arm reads it, from a bag: a sample of each time in which the arm stands still.
//
//   sensor_msgs/JointState   positions, of one or several nodes
//   sensor_msgs/Imu          linear_acceleration: conditions ax ay az, its mean while the joints are still;
//                            angular_velocity: turned_a _b _c, the rotation vector since the rest before, for a check
//
// The sensor is called accelerometer; its only feature is its frame, the frame_id of the messages.  Of several topics of
// sensor_msgs/Imu, the one counts that turns most against gravity: not that of the base.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The sensor of the samples.
inline constexpr const char* kAccelerometer = "accelerometer";

/// The samples; an error if the arm never stands still while an accelerometer is read.
/// @param diagnostics  receives errors in the bag; notes of topics that are not used; a doubt about readings that are not
///                     gravity in m/s^2
[[nodiscard]] std::vector<Sample> read_gravity(const std::string& path, Diagnostics& diagnostics);

}  // namespace kinecal
