// Reads recorded samples: the output of `rostopic echo` or `ros2 topic echo` for
// robot_calibration_msgs/CalibrationData, one YAML document per sample.
//
// `---` follows each sample, including the last: a file that ends otherwise may be truncated.  Keys
// are those of ROS 1 (D K R P) or ROS 2 (d k r p); unknown keys are skipped.  The depth driver's
// z_offset_mm becomes metres.  ROS sends an all-zero camera_info for a sensor that is not a camera;
// then Observation::camera stays unset.  In addition to the ROS messages, a feature may have an
// `orientation`, a `sigma` and an `id`, and a sample `conditions`.  NaN and infinity are valid
// values here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/progress_meter.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// All samples of a file without errors, in file order.
/// @param path         file of YAML documents
/// @param diagnostics  receives every error with its line, also if the file is unreadable or has no
///                     samples.  Throws nothing; call throw_if_errors()
/// @param threads      largest number of reading threads; 0: one per processor.  Does not affect
///                     the result
/// @param meter        receives the progress
/// @return             joint positions in radians or metres; points in metres or pixels, in the
///                     frame they name; Sample::source is "path:line"
[[nodiscard]] std::vector<Sample> read_samples(const std::string& path, Diagnostics& diagnostics,
                                               unsigned threads = 0,
                                               const ProgressMeter& meter = {});

/// The same from the text of such a file.
/// @param name_for_messages  name of the text in messages and in Sample::source: its file
[[nodiscard]] std::vector<Sample> parse_samples(const std::string& text,
                                                const std::string& name_for_messages,
                                                Diagnostics& diagnostics);

/// The complete samples of a file that was truncated while being written: those followed by `---`.
/// @param diagnostics  like read_samples(); a warning if the last sample is dropped
[[nodiscard]] std::vector<Sample> read_complete_samples(const std::string& path,
                                                        Diagnostics& diagnostics);

}  // namespace kinecal
