// The index of a ROS 1 bag: the chunks that hold messages of each connection.
//
// It is at the end of the file and written last, so an interrupted recording has no index.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/ros1/records.ipp"
#include "kinecal/files/bags/ros1/topics.ipp"

namespace kinecal::detail {

/// What the bag header, the first record, says about the index.
struct Ros1BagHeader {
  std::uint64_t index_place = 0;  ///< 0: the index has not been written
  std::uint32_t connections = 0, chunks = 0;
};

/// @throws BytesError  if the record is not a bag header, or the bag is encrypted
[[nodiscard]] inline Ros1BagHeader read_ros1_bag_header(ByteFile& file) {
  std::vector<std::byte> bytes;
  const Ros1Head head = read_ros1_head(file, bytes);
  if (head.fields.op() != Ros1Op::bag) {
    throw BytesError(at_byte(head.place) + "the bag header is missing");
  }
  const auto encryptor = head.fields.find("encryptor");
  if (encryptor && !encryptor->empty()) {
    throw BytesError("the bag is encrypted; record it without encryption");
  }
  Ros1BagHeader header;
  header.index_place = head.fields.number<std::uint64_t>("index_pos");
  header.connections = head.fields.number<std::uint32_t>("conn_count");
  header.chunks = head.fields.number<std::uint32_t>("chunk_count");
  skip_ros1_data(file, head);
  return header;
}

/// The connections of each chunk, by its place in the file.
using Ros1ChunkInfos = std::map<std::uint64_t, std::vector<std::uint32_t>>;

/// @throws BytesError  if the record is not a chunk info
inline void add_ros1_chunk_info(const Ros1Fields& header, Bytes data, std::uint64_t data_place,
                                Ros1ChunkInfos& chunks) {
  ByteReader reader(data, std::endian::little, data_place);
  if (header.number<std::uint32_t>("ver") != 1) reader.fail("a chunk info has an unknown version");
  std::vector<std::uint32_t>& connections = chunks[header.number<std::uint64_t>("chunk_pos")];
  const auto count = header.number<std::uint32_t>("count");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto connection = reader.number<std::uint32_t>();
    if (reader.number<std::uint32_t>() > 0) connections.push_back(connection);
  }
}

/// Reads the whole index.
/// @return  empty if the index is complete; otherwise the error, and `chunks` is empty
[[nodiscard]] inline std::string read_ros1_index(ByteFile& file, const Ros1BagHeader& header,
                                                 Ros1Topics& topics, Ros1ChunkInfos& chunks) {
  std::uint64_t connections = 0, infos = 0;
  std::vector<std::byte> header_bytes, data;
  try {
    if (header.index_place < file.place() || header.index_place > file.size()) {
      throw BytesError("it should begin at byte " + std::to_string(header.index_place) +
                       ", which is not in the file");
    }
    file.go_to(header.index_place);
    while (file.left() > 0) {
      const Ros1Head head = read_ros1_head(file, header_bytes);
      const Ros1Op op = head.fields.op();
      if (op == Ros1Op::connection) {
        topics.add(head.fields, read_ros1_data(file, head, data), head.data_place);
        ++connections;
      } else if (op == Ros1Op::chunk_info) {
        add_ros1_chunk_info(head.fields, read_ros1_data(file, head, data), head.data_place, chunks);
        ++infos;
      } else {
        throw BytesError(at_byte(head.place) + "a record that does not belong to an index");
      }
    }
    if (connections != header.connections || infos != header.chunks) {
      throw BytesError("it has " + std::to_string(connections) + " of " +
                       std::to_string(header.connections) + " connections and " +
                       std::to_string(infos) + " of " + std::to_string(header.chunks) + " chunks");
    }
  } catch (const BytesError& e) {
    chunks.clear();
    return e.what();
  }
  return "";
}

}  // namespace kinecal::detail
