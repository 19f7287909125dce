// The records of a ROS 1 bag, read from bytes or from a file.
//
//   record = header length (4), header, data length (4), data        lengths are little endian
//   header = fields, each: length (4), name '=' value; the field `op` gives the kind of record
//
// A bag is the magic text, the bag header, chunks, each with an index of its messages, and the
// index of the bag: connections and chunk infos.  The data of a chunk are records, too: connections
// and messages.
// Source: wiki.ros.org/Bags/Format/2.0
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/unpack.ipp"

namespace kinecal::detail {

inline constexpr std::string_view kRos1Magic = "#ROSBAG V2.0\n";
inline constexpr std::size_t kRos1BagHeaderSize = 4096;  ///< header and data, padded

enum class Ros1Op : std::uint8_t {
  message = 0x02,
  bag = 0x03,
  index = 0x04,
  chunk = 0x05,
  chunk_info = 0x06,
  connection = 0x07,
};

/// The fields of a header, or the data of a connection.
class Ros1Fields {
 public:
  Ros1Fields() = default;
  /// @param place  of the first byte in its file
  Ros1Fields(Bytes bytes, std::uint64_t place) : bytes_(bytes), place_(place) {}

  /// @throws BytesError  if something before it is not a field
  [[nodiscard]] std::optional<Bytes> find(std::string_view name) const {
    ByteReader reader(bytes_, std::endian::little, place_);
    while (!reader.at_end()) {
      const std::string_view field = reader.text(reader.number<std::uint32_t>());
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) reader.fail("a field without '=' ends here");
      if (field.substr(0, equals) == name) {
        return as_bytes(field.substr(equals + 1));
      }
    }
    return std::nullopt;
  }

  /// @throws BytesError  if it is missing
  [[nodiscard]] Bytes bytes(std::string_view name) const {
    const std::optional<Bytes> found = find(name);
    if (!found) fail("there is no field '" + std::string(name) + "'");
    return *found;
  }

  /// @throws BytesError  if it is missing, or of another size
  template <std::integral T>
  [[nodiscard]] T number(std::string_view name) const {
    const Bytes value = bytes(name);
    if (value.size() != sizeof(T)) {
      fail("the field '" + std::string(name) + "' has " + byte_count(value.size()) + ", not " +
           std::to_string(sizeof(T)));
    }
    return ByteReader(value).number<T>();
  }

  [[nodiscard]] std::string_view text(std::string_view name) const {
    const Bytes value = bytes(name);
    return {reinterpret_cast<const char*>(value.data()), value.size()};
  }

  [[nodiscard]] Ros1Op op() const { return Ros1Op{number<std::uint8_t>("op")}; }

 private:
  /// Reports the position of the header, because a missing field has none.
  [[noreturn]] void fail(const std::string& what) const {
    ByteReader(bytes_, std::endian::little, place_).fail(what + " in the header of this record");
  }

  Bytes bytes_;
  std::uint64_t place_ = 0;
};

struct Ros1Record {
  Ros1Fields fields;
  Bytes data;
  std::uint64_t data_place = 0;
};

/// The next record of a chunk.
/// @throws BytesError  if it is cut off
[[nodiscard]] inline Ros1Record next_ros1_record(ByteReader& chunk) {
  const auto header_size = chunk.number<std::uint32_t>();
  const std::uint64_t header_place = chunk.place();
  const Ros1Fields fields(chunk.take(header_size), header_place);
  const auto data_size = chunk.number<std::uint32_t>();
  const std::uint64_t data_place = chunk.place();
  return {fields, chunk.take(data_size), data_place};
}

/// @return  nanoseconds of a time field: seconds (4), nanoseconds (4)
/// @throws BytesError  if it is missing, or of another size
[[nodiscard]] inline std::int64_t ros1_time(const Ros1Fields& fields, std::string_view name) {
  const auto both = fields.number<std::uint64_t>(name);
  const auto seconds = static_cast<std::int64_t>(both & 0xffffffffU);
  return 1'000'000'000 * seconds + static_cast<std::int64_t>(both >> 32);
}

/// The start of a record in the file: its header, with the data still unread.
struct Ros1Head {
  std::uint64_t place = 0;
  Ros1Fields fields;
  std::uint64_t data_place = 0;
  std::uint32_t data_size = 0;
};

/// The record that begins here, without its data.
/// @param header  holds its fields
/// @throws CutOffError  if it ends beyond the file
/// @throws BytesError   if no record begins here
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
    throw BytesError(at_byte(head.place) + "no record begins here");
  }
  const std::uint64_t header_place = file.place();
  head.fields = Ros1Fields(file.read(header_size, header), header_place);
  head.data_size = number();
  head.data_place = file.place();
  return head;
}

/// @param data  receives them
/// @throws CutOffError  if they end beyond the file
/// @throws BytesError   if there are more than a block may have
[[nodiscard]] inline Bytes read_ros1_data(ByteFile& file, const Ros1Head& head,
                                          std::vector<std::byte>& data) {
  if (head.data_size > kMostOfABlock) {
    throw BytesError(at_byte(head.place) + "a record of " + byte_count(head.data_size) +
                     "; the most that is read is " + std::to_string(kMostOfABlock));
  }
  file.go_to(head.data_place);
  return file.read(head.data_size, data);
}

/// Skips to the next record, if any.
/// @throws CutOffError  if the data end beyond the file
inline void skip_ros1_data(ByteFile& file, const Ros1Head& head) {
  if (head.data_size > file.size() - head.data_place) {
    throw CutOffError(at_byte(head.place) + "a record of " + byte_count(head.data_size) +
                      " begins here and ends beyond the file");
  }
  file.go_to(head.data_place + head.data_size);
}

}  // namespace kinecal::detail
