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
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/samples/sample_handler.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

namespace detail {

/// Reads one document after the other, until the first that is not YAML.
inline void parse_samples(std::istream& in, SampleHandler& handler) {
  SampleErrors& errors = handler.builder().errors();
  try {
    YAML::Parser parser(in);
    while (errors.count <= SampleErrors::kMost && parser.HandleNextDocument(handler)) {
    }
  } catch (const YAML::Exception& e) {
    const int line = e.mark.is_null() ? 0 : e.mark.line + 1;
    const int sample_line = handler.builder().sample_line();
    const std::string sample =
        sample_line > 0 ? fmt::format(" the last sample begins at line {};", sample_line) : "";
    const std::string what =
        e.msg == YAML::ErrorMsg::BAD_FILE ? "lists and maps are nested too deeply" : e.msg;
    errors.add(line, fmt::format("not YAML: {};{} is the file cut off?", what, sample));
  }
  if (errors.count <= SampleErrors::kMost) return;
  errors.diagnostics.error(
      {errors.file, handler.builder().sample_line()},
      fmt::format("more than {} mistakes; those that follow are not told", SampleErrors::kMost));
}

/// A recording that was interrupted may end in the middle of a number and still be YAML.
inline void check_end(std::istream& in, SampleHandler& handler) {
  if (handler.last_document_is_empty()) return;
  const SampleErrors& errors = handler.builder().errors();
  const Place place{errors.file, handler.builder().sample_line()};
  in.clear();
  in.seekg(-1, std::ios::end);
  const int last = in ? in.get() : '\n';
  if (last == '\n' || last == '}' || last == ']') {
    errors.diagnostics.warning(place,
                               "no '---' after this sample, the last one; if the file is cut off, "
                               "observations are missing");
  } else {
    errors.diagnostics.error(place,
                             "the file ends within a line of this sample, the last one; if it is "
                             "not cut off, add a line '---'");
  }
}

}  // namespace detail

/// All samples of a file, in its order; those with a mistake are left out.
/// @param path         file of YAML documents
/// @param diagnostics  receives every mistake with its line, also that the file cannot be read or
///                     holds no samples; nothing is thrown, throw_if_errors() is for the caller
/// @return             joint positions in radians or metres, points in metres or pixels in the
///                     frame they name; Sample::source is "path:line"
[[nodiscard]] inline std::vector<Sample> read_samples(const std::string& path,
                                                      Diagnostics& diagnostics) {
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
  detail::SampleHandler handler(path, diagnostics);
  detail::parse_samples(in, handler);
  std::vector<Sample> samples = handler.take();
  if (handler.builder().errors().count > 0) return samples;
  if (samples.empty()) {
    diagnostics.error({path, 0}, "no samples in this file");
  } else {
    detail::check_end(in, handler);
  }
  return samples;
}

}  // namespace kinecal
