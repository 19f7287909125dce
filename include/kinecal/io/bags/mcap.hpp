// Reads MCAP files, in which ROS 2 records by default: chunks of messages, plain, LZ4 or zstd.
//
// In memory is one chunk, packed and unpacked.  Check sums of chunks and of the index are checked
// where they are told; that of the whole file is not, since it demands to read everything.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <istream>
#include <optional>
#include <string>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/byte_file.hpp"
#include "kinecal/io/bags/mcap_messages.hpp"
#include "kinecal/io/diagnostics.hpp"

namespace kinecal {

/// All wanted messages of a file, in its order.
/// @param in           seekable
/// @param name         as messages name the file
/// @param diagnostics  receives what is wrong with the file, at most one error, after which nothing
///                     is read; and as a warning that the recording was interrupted: all chunks
///                     that are whole are then read.  Only what the handler throws is thrown.
inline void read_mcap(std::istream& in, const std::string& name, const BagReader& reader,
                      Diagnostics& diagnostics) {
  std::optional<ByteFile> file;
  std::optional<detail::McapMessages> messages;
  const auto advance = [&]() -> std::optional<BagMessage> {
    try {
      if (!messages) {
        file.emplace(in);
        messages.emplace(*file, reader, Place{name, 0}, diagnostics);
      }
      return messages->next();
    } catch (const BytesError& e) {
      diagnostics.error({name, 0}, e.what());
      return std::nullopt;
    }
  };
  // What the reader throws is no mistake of the file.
  while (const std::optional<BagMessage> message = advance()) reader.handle(*message);
}

/// @param path  of an .mcap file
/// @param name  as messages name the file
inline void read_mcap(const std::string& path, const std::string& name, const BagReader& reader,
                      Diagnostics& diagnostics) {
  std::ifstream in;
  try {
    in = open_bytes(path);
  } catch (const BytesError& e) {
    diagnostics.error({name, 0}, e.what());
    return;
  }
  read_mcap(in, name, reader, diagnostics);
}

inline void read_mcap(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  read_mcap(path, path, reader, diagnostics);
}

}  // namespace kinecal
