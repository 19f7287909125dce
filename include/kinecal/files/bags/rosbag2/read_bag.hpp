// Reads a ROS 2 bag: a folder with metadata.yaml and the .db3 or .mcap files that it lists.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Reads the wanted messages of a bag, file after file.  Asks the reader about topics for each file
/// again.
/// @param folder       with metadata.yaml
/// @param diagnostics  receives errors in the bag.  If a listed file is missing, nothing is read.
///                     Throws only exceptions of the reader's functions.
void read_ros2_bag(const std::string& folder, const BagReader& reader, Diagnostics& diagnostics);

namespace detail {

/// Reads one file of a bag, .mcap, .db3 or either in zstd, identified by its first bytes.
void read_ros2_bag_file(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace detail

}  // namespace kinecal
