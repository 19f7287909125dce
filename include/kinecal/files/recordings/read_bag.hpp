// Reads bags of any format, identified by content, not by name.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Formats of recordings.
enum class RecordingFormat { yaml, ros1_bag, mcap, sqlite, ros2_bag, zstd };

/// The name of a format in messages.
[[nodiscard]] std::string_view to_string(RecordingFormat format);

/// The format of a file by its first bytes.  A folder is a ROS 2 bag.  Everything else counts as
/// YAML, also an unreadable file: the YAML reader then reports it.
[[nodiscard]] RecordingFormat recording_format(const std::string& path);

/// Reads a bag of any format, but not YAML.
/// @param diagnostics  receives errors in the bag, which are not thrown
void read_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal
