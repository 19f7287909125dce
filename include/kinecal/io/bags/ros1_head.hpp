// How a record of a ROS 1 bag begins: its header, with the data unread until they are asked for.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kinecal/io/bags/byte_file.hpp"
#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/ros1_record.hpp"
#include "kinecal/io/bags/unpack.hpp"

namespace kinecal::detail {

struct Ros1Head {
  std::uint64_t place = 0;
  Ros1Fields fields;
  std::uint64_t data_place = 0;
  std::uint32_t data_size = 0;
};

/// The record that begins here, without its data.
/// @param header  what its fields are kept in
/// @throws CutOffError  if it does not end in the file
/// @throws BytesError   if there is none
[[nodiscard]] inline Ros1Head read_ros1_head(ByteFile& file, std::vector<std::byte>& header) {
  constexpr std::uint32_t kMostOfAHeader = 1 << 20;  // real ones have some 100 bytes
  std::array<std::byte, sizeof(std::uint32_t)> raw;
  const auto number = [&] {
    file.read(raw);
    return ByteReader(raw).number<std::uint32_t>();
  };
  Ros1Head head;
  head.place = file.place();
  const std::uint32_t header_size = number();
  if (header_size > kMostOfAHeader) {
    throw BytesError("byte " + std::to_string(head.place) + ": no record begins here");
  }
  const std::uint64_t header_place = file.place();
  head.fields = Ros1Fields(file.read(header_size, header), header_place);
  head.data_size = number();
  head.data_place = file.place();
  return head;
}

/// @param data  what they are kept in
/// @throws CutOffError  if they do not end in the file
/// @throws BytesError   if there are more than a block may have
[[nodiscard]] inline Bytes read_ros1_data(ByteFile& file, const Ros1Head& head,
                                          std::vector<std::byte>& data) {
  if (head.data_size > kMostOfABlock) {
    throw BytesError("byte " + std::to_string(head.place) + ": a record of " +
                     std::to_string(head.data_size) + " bytes; the most that is read is " +
                     std::to_string(kMostOfABlock));
  }
  file.go_to(head.data_place);
  return file.read(head.data_size, data);
}

/// To the record that follows, if there is one.
/// @throws CutOffError  if the data do not end in the file
inline void skip_ros1_data(ByteFile& file, const Ros1Head& head) {
  if (head.data_size > file.size() - head.data_place) {
    throw CutOffError("byte " + std::to_string(head.place) + ": a record of " +
                      std::to_string(head.data_size) + " bytes begins here");
  }
  file.go_to(head.data_place + head.data_size);
}

}  // namespace kinecal::detail
