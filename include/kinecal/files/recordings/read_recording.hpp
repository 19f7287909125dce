// Reads samples, and the robot they were recorded on, from a file of any format.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/files/recordings/bag_topics.hpp"
#include "kinecal/files/recordings/read_bag.hpp"
#include "kinecal/files/samples/read_samples.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The content of a recording.
struct Recording {
  /// Like the result of read_samples().  Sample::source of a bag is "path:number of the message".
  std::vector<Sample> samples;
  std::string urdf;  ///< the last /robot_description; empty if absent
};

/// Reads YAML, samples of MoveIt Calibration or easy_handeye2, a ROS 1 bag, MCAP or a ROS 2 bag,
/// identified by content, or a table with a columns.yaml beside it.  Sets Sample::joint_moves and,
/// where no velocity was recorded, Sample::joint_velocities: samples/joint_moves.hpp.
/// @param diagnostics  receives every error, also if there are no samples
/// @param threads      like read_samples()
/// @param meter        like read_samples()
[[nodiscard]] Recording read_recording(const std::string& path, Diagnostics& diagnostics,
                                       unsigned threads = 0, const ProgressMeter& meter = {});

/// Like read_recording(), but the samples have only what is in the file: to be copied.
[[nodiscard]] Recording read_as_recorded(const std::string& path, Diagnostics& diagnostics,
                                         unsigned threads = 0, const ProgressMeter& meter = {});

/// True if a bag without samples of robot_calibration gives samples all the same: the drive of a base, the readings of a
/// magnetometer, or of an accelerometer on an arm.
/// @param topics  all of the bag
[[nodiscard]] bool gives_sensed_samples(const std::vector<TopicContent>& topics);

}  // namespace kinecal
