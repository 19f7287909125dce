// Reads MCAP files, ROS 2's default format: chunks of messages, plain, LZ4 or zstd.
//
// One chunk at a time is in memory, packed and unpacked.  Check sums of chunks and of the index are
// checked; that of the whole file is not, since it would require reading everything.
//
// It is read by hand, as Debian 12 has no library for MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

/// Reads the wanted messages of a file, in file order.
/// @param in           seekable
/// @param name         of the file, for messages
/// @param diagnostics  receives at most one error, which ends reading, and a warning if the
///                     recording was interrupted; then all complete chunks are read.  Throws only
///                     exceptions of the reader's functions.
void read_mcap(std::istream& in, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics);

/// The same for a file.
/// @param path  of an .mcap file
/// @param name  of the file, for messages
void read_mcap(const std::string& path, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics);

/// The same, with the path as name.
void read_mcap(const std::string& path, const BagReader& reader, Diagnostics& diagnostics);

}  // namespace kinecal
