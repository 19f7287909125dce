// Reads recorded samples: what `rostopic echo` or `ros2 topic echo` prints for
// robot_calibration_msgs/CalibrationData, one YAML document for each sample.
//
// `---` stands after each sample, also after the last one: a file that ends otherwise may be cut
// off.  Keys are those of ROS 1 (D K R P) or ROS 2 (d k r p); unknown keys are skipped.  The depth
// driver's z_offset_mm becomes metres.  ROS sends a camera_info of zeros for a sensor that is not a
// camera: it leaves Observation::camera unset.  Beyond the messages of ROS, a feature may have an
// `orientation`, a `sigma` and an `id`, and a sample `conditions`.  NaN and infinity are values like any
// other here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// All samples of a file, in its order, without those that have errors.
/// @param path         file of YAML documents
/// @param diagnostics  receives every error with its line, also that the file cannot be read or
///                     has no samples.  Nothing is thrown; the caller calls throw_if_errors()
/// @param threads      threads to read with, at most; 0 for as many as there are processors.  The
///                     result does not depend on it
/// @param meter        is told how much of the file has been read
/// @return             joint positions in radians or metres; points in metres or pixels, in the
///                     frame they name; Sample::source is "path:line"
[[nodiscard]] std::vector<Sample> read_samples(const std::string& path, Diagnostics& diagnostics,
                                               unsigned threads = 0,
                                               const ProgressMeter& meter = {});

/// The samples of a file that was cut off while it was written: those with `---` after them.
/// @param diagnostics  as for read_samples(); a warning if the last sample is left out
[[nodiscard]] std::vector<Sample> read_complete_samples(const std::string& path,
                                                        Diagnostics& diagnostics);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/samples/read_samples.ipp"
#endif
