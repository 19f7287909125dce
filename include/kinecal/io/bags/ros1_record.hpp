// The records that a ROS 1 bag consists of.
//
//   record = header length (4), header, data length (4), data        lengths are little endian
//   header = fields, each: length (4), name '=' value; one of them, op, says what the record is
//
// After the magic text: the bag header; chunks, each followed by an index of its messages; then the
// index of all: connections and chunk infos.  A chunk's data are records as well: connections and
// messages.
// Source: wiki.ros.org/Bags/Format/2.0
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "kinecal/io/bags/bytes.hpp"

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

  /// @throws BytesError  if a field in front of it is not one
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
      fail("the field '" + std::string(name) + "' has " + std::to_string(value.size()) +
           " bytes, not " + std::to_string(sizeof(T)));
    }
    return ByteReader(value).number<T>();
  }

  [[nodiscard]] std::string_view text(std::string_view name) const {
    const Bytes value = bytes(name);
    return {reinterpret_cast<const char*>(value.data()), value.size()};
  }

  [[nodiscard]] Ros1Op op() const { return Ros1Op{number<std::uint8_t>("op")}; }

 private:
  /// Names the place of the header: what it lacks has none.
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

}  // namespace kinecal::detail
