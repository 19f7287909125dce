// Writes samples in the format given by the file's extension.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/results/output_file.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The encoding of the bag, by extension: .bag is ROS 1, .mcap ROS 2; nullopt for .yaml and .yml.
/// @throws InputError  for any other extension
[[nodiscard]] std::optional<Encoding> output_encoding(const std::string& path);

/// Writes samples as YAML, ROS 1 bag or MCAP.  The file gets its name when it is complete; it
/// replaces an existing file only on success.
/// @param existing  what becomes of a file of that name
/// @param urdf  stored in bags as /robot_description; empty: none
/// @throws InputError   for another extension
/// @throws OutputError  if the file cannot be written
void write_recording(const std::string& path, const std::vector<Sample>& samples,
                     const std::string& urdf = {}, Existing existing = Existing::replaced);

}  // namespace kinecal
