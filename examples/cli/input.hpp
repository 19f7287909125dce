// The input of a calibration, read from the user's files; every mistake is told in one go.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/io/diagnostics.hpp"
#include "kinecal/io/recordings/read_recording.hpp"
#include "kinecal/solve/calibrate.hpp"

namespace kinecal::cli {

struct Input {
  Robot robot;
  std::string urdf, urdf_text;  ///< where the text is from, as messages name it
  std::vector<Sample> samples;
  Calibration calibration;
  Diagnostics diagnostics;
};

/// Reads and assembles everything; mistakes end up in the diagnostics.
/// @param urdf     empty: the /robot_description of the samples' bag
/// @param cameras  NAME=FILE, for samples without camera_info
[[nodiscard]] Input read_input(const std::string& urdf, const std::string& config,
                               const std::vector<std::string>& samples,
                               const std::vector<std::string>& cameras = {});

/// Reads samples from several files of any format, the URDF from the first that has one; mistakes
/// end up in the diagnostics.
[[nodiscard]] Recording read_recordings(const std::vector<std::string>& files,
                                        Diagnostics& diagnostics);

/// Prints warnings and errors to the standard error stream.
void print(const Diagnostics& diagnostics);

}  // namespace kinecal::cli
