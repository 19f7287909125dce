// Reads .db3 files, the SQLite databases of ROS 2's default format before MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Reads the wanted messages of a file, in time order.
/// @param path         of a .db3 file
/// @param name         of the file, for messages
/// @param diagnostics  receives at most one error, which ends reading; also if this build lacks
///                     SQLite.  Throws only exceptions of the reader's functions.
void read_db3(const std::string& path, const std::string& name, const BagReader& reader,
              Diagnostics& diagnostics);

/// The same, with the path as name.
void read_db3(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal
