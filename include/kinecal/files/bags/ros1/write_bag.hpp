// Writes a ROS 1 bag, version 2.0, for read_ros1_bag() and rosbag.
//
//   std::ofstream out("samples.bag", std::ios::binary);
//   Ros1BagWriter bag(out);
//   const auto samples = bag.add_topic({.name = "/calibration_data", .type = ..., .md5 = ...});
//   bag.write(samples, time, bytes);
//   bag.close();
//
// The same calls write the same bytes.  Without close() the bag is like an interrupted recording.  By hand, as
// it is read: rosbag_storage brings parts of ROS 1 with it.
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
class Ros1BagFile;
}

/// One bag.  close() ends it.
class Ros1BagWriter {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{768} << 10;  ///< as in rosbag

  /// @param out          binary and seekable; the bag begins at its position
  /// @param compression  none, bz2 or lz4: rosbag reads these
  /// @param chunk_bytes  size of messages after which a chunk ends
  /// @throws std::invalid_argument  if the compression is another, or not available
  /// @throws std::runtime_error     if the stream cannot be written
  explicit Ros1BagWriter(std::ostream& out, Compression compression = Compression::none,
                         std::size_t chunk_bytes = kChunkBytes);
  ~Ros1BagWriter();
  /// Takes over the bag.
  Ros1BagWriter(Ros1BagWriter&&) noexcept;
  /// Takes over the bag.  Close the bag written so far first.
  Ros1BagWriter& operator=(Ros1BagWriter&&) noexcept;

  /// @param topic     with type, md5 and definition; the name as in ROS, with its leading slash
  /// @param latching  true if the last message is sent to later subscribers
  /// @return          its number, for write()
  /// @throws std::invalid_argument  if the bag is closed
  [[nodiscard]] std::uint32_t add_topic(const BagTopic& topic, bool latching = false);

  /// @param topic  from add_topic()
  /// @param time   of recording, nanoseconds since 1970
  /// @throws std::invalid_argument  if there is no such topic, the time is not within 1970 to 2106,
  ///                                the message has more than half a GiB, or the bag is closed
  /// @throws std::runtime_error     if the stream cannot be written
  void write(std::uint32_t topic, std::int64_t time, Bytes data);

  /// Writes the rest, and the index.
  /// @throws std::runtime_error  if the stream cannot be written
  void close();

 private:
  std::unique_ptr<detail::Ros1BagFile> file_;
};

}  // namespace kinecal
