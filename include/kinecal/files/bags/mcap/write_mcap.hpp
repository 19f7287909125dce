// Writes MCAP files as ROS 2 does: profile ros2, schemas ros2msg, messages in CDR; or of JSON.
//
// The same calls write the same bytes.  The index and the summary at the end list what the chunks
// hold, so that readers go straight to what they want.  By hand: Debian 12 has no library for MCAP.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/compression.hpp"

namespace kinecal {

namespace detail {
class McapFile;
}

/// How an MCAP file is written.
struct McapOptions {
  Compression compression = Compression::none;     ///< of chunks
  std::size_t chunk_bytes = std::size_t{1} << 20;  ///< after which a chunk ends; 0: no chunks
  bool index = true;                               ///< of messages and chunks, and the summary
  /// Messages are JSON and definitions JSON schemas, as viewers take them, and there is no profile.
  bool json = false;
};

/// zstd if this kinecal was built with it, or else none.
[[nodiscard]] Compression best_mcap_compression();

/// One file.  close() ends it; then ask the stream whether everything was written.
class McapWriter {
 public:
  /// @param out  at its beginning
  explicit McapWriter(std::ostream& out, McapOptions options = {});
  ~McapWriter();
  /// Takes over the file.
  McapWriter(McapWriter&&) noexcept;
  /// Takes over the file.  Close the file written so far first.
  McapWriter& operator=(McapWriter&&) noexcept;

  /// @return  the number by which write() knows the topic
  /// @throws std::invalid_argument  if its messages are not in CDR, or if there are 65535 topics
  [[nodiscard]] std::uint16_t add_topic(const BagTopic& topic);

  /// @param topic  from add_topic()
  /// @param time   of recording, nanoseconds, not negative
  /// @param data   CDR with the four bytes that stand before it; or JSON
  /// @throws std::out_of_range      if there is no such topic
  /// @throws std::invalid_argument  if the time is negative, or the message larger than half a GiB
  void write(std::uint16_t topic, std::int64_t time, Bytes data);

  /// Ends the file; after it, call nothing else.
  void close();

 private:
  std::unique_ptr<detail::McapFile> file_;
};

}  // namespace kinecal

#ifdef KINECAL_HEADER_ONLY
#include "kinecal/files/bags/mcap/write_mcap.ipp"
#endif
