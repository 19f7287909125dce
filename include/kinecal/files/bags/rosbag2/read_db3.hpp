// Reads .db3 files, the SQLite databases into which ROS 2 recorded by default before MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Reads the wanted messages of a file, in the order of time.
/// @param path         of a .db3 file
/// @param name         of the file, with which messages begin
/// @param diagnostics  receives what is wrong with the file, at most one error, at which reading
///                     ends; also that this kinecal was built without SQLite.  Only what the
///                     reader's functions throw is thrown.
void read_db3(const std::string& path, const std::string& name, const BagReader& reader,
              Diagnostics& diagnostics);

/// The same; messages begin with the path.
void read_db3(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/bags/rosbag2/read_db3.ipp"
#endif
