// Writes MCAP files like ROS 2: profile ros2, schemas ros2msg, messages in CDR; or JSON messages.
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

/// Options for writing an MCAP file.
struct McapOptions {
  Compression compression = Compression::none;     ///< of chunks
  std::size_t chunk_bytes = std::size_t{1} << 20;  ///< after which a chunk ends; 0: no chunks
  bool index = true;                               ///< of messages and chunks, and the summary
  /// Messages are JSON and definitions JSON schemas, for viewers; no profile.
  bool json = false;
};

/// zstd if this build has it, else none.
[[nodiscard]] Compression best_mcap_compression();

/// One file.  close() ends it; then check the stream for errors.
class McapWriter {
 public:
  /// @param out  positioned at its beginning
  explicit McapWriter(std::ostream& out, McapOptions options = {});
  ~McapWriter();
  /// Takes over the file.
  McapWriter(McapWriter&&) noexcept;
  /// Takes over the file.  Close the file written so far first.
  McapWriter& operator=(McapWriter&&) noexcept;

  /// @return  the topic's number, for write()
  /// @throws std::invalid_argument  if its encoding is not CDR, or there are already 65535 topics
  [[nodiscard]] std::uint16_t add_topic(const BagTopic& topic);

  /// @param topic  from add_topic()
  /// @param time   of recording, nanoseconds, not negative
  /// @param data   CDR with its four-byte header; or JSON
  /// @throws std::out_of_range      if there is no such topic
  /// @throws std::invalid_argument  if the time is negative, or the message larger than half a GiB
  void write(std::uint16_t topic, std::int64_t time, Bytes data);

  /// Ends the file; call nothing afterwards.
  void close();

 private:
  std::unique_ptr<detail::McapFile> file_;
};

}  // namespace kinecal
