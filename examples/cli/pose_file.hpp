// A file of poses: YAML or a bag, by its name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "kinecal/io/poses/poses.hpp"

namespace kinecal::cli {

/// Poses of a file of any format.  Prints warnings and errors.
/// @throws InputError  if there are errors or no poses
[[nodiscard]] std::vector<CapturePose> read_pose_file(const std::string& path);

/// Writes poses in the format of the file's name.  The file gets its name when it is complete; without
/// poses there is none.
/// @throws InputError   if the name asks for another format
/// @throws OutputError  if the file cannot be written
void write_pose_file(const std::string& path, const std::vector<CapturePose>& poses);

}  // namespace kinecal::cli
