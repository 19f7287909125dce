// Reads a ROS 1 bag, version 2.0, as `rosbag record` writes it, with one chunk at a time in memory.
//
// An interrupted recording is read as far as it goes, with a warning.  That is why it is read by hand:
// rosbag_storage refuses it until `rosbag reindex` has rewritten it, and brings parts of ROS 1 with it.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Reads the wanted messages in file order, nearly that of recording.
/// @param in           seekable
/// @param name         of the bag, for messages
/// @param diagnostics  receives every error with its byte.  Throws only exceptions of the reader's
///                     functions.
void read_ros1_bag(std::istream& in, const std::string& name, const BagReader& reader,
                   Diagnostics& diagnostics);

/// @param diagnostics  also receives an error if the file cannot be read
void read_ros1_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal
