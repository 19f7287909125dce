// Reads recorded samples: what `rostopic echo` or `ros2 topic echo` prints for
// robot_calibration_msgs/CalibrationData, one YAML document a sample.
//
// `---` stands after each sample, the last one included: a file that ends otherwise may be cut off.
// Keys are those of ROS 1 (D K R P) or ROS 2 (d k r p); unknown ones are skipped.  The depth
// driver's z_offset_mm becomes metres.  A camera_info of zeros, as ROS sends it for a sensor that
// is no camera, leaves Observation::camera unset.  NaN and infinity are values like any other here.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/samples/sample_file.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// All samples of a file, in its order; those with a mistake are left out.
/// @param path         file of YAML documents
/// @param diagnostics  receives every mistake with its line, also that the file cannot be read or
///                     holds no samples; nothing is thrown, throw_if_errors() is for the caller
/// @param threads      how many read at once, at most, 0 for as many as there are processors; the
///                     result does not depend on it
/// @return             joint positions in radians or metres, points in metres or pixels in the
///                     frame they name; Sample::source is "path:line"
[[nodiscard]] inline std::vector<Sample> read_samples(const std::string& path,
                                                      Diagnostics& diagnostics,
                                                      unsigned threads = 0) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    diagnostics.error({path, 0}, "is a folder, not a file of samples");
    return {};
  }
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) {
    diagnostics.error({path, 0}, fmt::format("cannot be opened: {}", std::strerror(errno)));
    return {};
  }
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  std::error_code unknown;  // the size of a pipe; the number of threads then bounds
  const std::uintmax_t size = std::filesystem::file_size(path, unknown);
  detail::SampleFile file(in, path);
  const std::uintmax_t pieces = size / detail::SampleFile::kPieceBytes + 1;
  file.read(static_cast<std::size_t>(std::min<std::uintmax_t>(threads, pieces)));
  if (in.bad()) {
    diagnostics.error({path, 0}, "cannot be read to its end");
    return {};
  }
  return file.take(diagnostics);
}

}  // namespace kinecal
