// Converts recordings from one format to another.
//
// Between bags of the same encoding, messages are copied unchanged.  From ROS 1 to ROS 2 and back,
// messages of known types are decoded and encoded; a warning lists the skipped topics.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/bag_output.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Whether to write images and point clouds of observations.  Calibration does not use them.
enum class Clouds { keep, drop };

/// Writes the content of a bag into another one.
/// @param diagnostics  receives errors in the bag, and warnings about skipped topics
/// @return             number of messages written
std::size_t convert_bag(const std::string& from, BagOutput& to, Clouds clouds,
                        Diagnostics& diagnostics);

/// Writes samples as messages on /calibration_data, one per second.
void write_samples(BagOutput& to, const std::vector<Sample>& samples);

/// Writes a URDF as a message on /robot_description.
void write_urdf(BagOutput& to, const std::string& urdf);

}  // namespace kinecal
