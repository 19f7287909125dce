// Reads camera intrinsics from a file: a camera_info file or message, Kalibr's camchain, OpenCV's
// FileStorage.  The content identifies the format.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/diagnostics.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// Reads a camera.
/// @param path         a YAML file, or one of OpenCV in XML
/// @param diagnostics  receives errors and warnings, each with "file:line: "
/// @param which        one of several cameras in a file: cam1; of M1 D1 M2 D2: 1 or 2
/// @return             incomplete if there are errors; z_offset 0 and z_scaling 1
/// @throws InputError  if the file cannot be read or is not YAML
[[nodiscard]] CameraInfo read_camera_file(const std::string& path, Diagnostics& diagnostics,
                                          const std::string& which = {});

/// Reads a camera from "file.yaml" or "file.yaml:cam1".  If a file has the whole argument as its
/// name, colons included, reads that file.
[[nodiscard]] CameraInfo read_camera_argument(const std::string& argument,
                                              Diagnostics& diagnostics);

}  // namespace kinecal
