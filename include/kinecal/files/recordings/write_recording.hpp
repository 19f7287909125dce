// Writes samples in the format that the name of the file asks for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/samples/sample.hpp"

namespace kinecal {

/// The encoding of the bag that a name asks for: .bag is ROS 1, .mcap ROS 2; nullopt for .yaml and .yml.
/// @throws InputError  if the name ends otherwise
[[nodiscard]] std::optional<Encoding> output_encoding(const std::string& path);

/// Writes samples as YAML, ROS 1 bag or MCAP.  The file gets its name when it is complete; one of that
/// name is replaced, and stays if an error occurs.
/// @param urdf  put into bags as /robot_description; empty: none
/// @throws InputError   if the name asks for another format
/// @throws OutputError  if the file cannot be written
void write_recording(const std::string& path, const std::vector<Sample>& samples,
                     const std::string& urdf = {});

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/recordings/write_recording.ipp"
#endif
