// The readings of a magnetometer from a bag: conditions mag_x mag_y mag_z of samples, in millionths of the topic's unit, which
// is microtesla of sensor_msgs/MagneticField.
//
//   sensor_msgs/MagneticField         magnetic_field, tesla
//   geometry_msgs/Vector3Stamped      vector, on a topic with a word that begins with mag in its name
//
// Readings in succession that are near to each other are one sample, their mean: a turn of a minute is some hundred samples,
// and what stands still counts once.  Of several topics, imu/mag counts, as in magnetometer_calibration of
// robot_calibration; else the first.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// True for a topic of a magnetometer.
[[nodiscard]] bool shows_magnetic_field(const BagTopic& topic);

/// The samples; none without readings.
/// @param diagnostics  receives errors in the bag; notes of topics that are not used, of readings that are not numbers, and of
///                     a unit that is not tesla
[[nodiscard]] std::vector<Sample> read_magnetometer(const std::string& path,
                                                    Diagnostics& diagnostics);

}  // namespace kinecal
