// Bags of any format, recognized by their content and not by their names.
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

/// The format of a file by its first bytes.  A folder is a bag of ROS 2.  Everything else is YAML,
/// also a file that cannot be read: its reader then reports that.
[[nodiscard]] RecordingFormat recording_format(const std::string& path);

/// Reads a bag of any format, but not YAML.
/// @param diagnostics  receives what is wrong with the bag; nothing is thrown for that
void read_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/recordings/read_bag.ipp"
#endif
