// The records of an MCAP file, with their fields in the order of the file.
//
//   file = magic, Header, data, DataEnd, [summary], Footer, magic
//   record = uint8 opcode, uint64 length, content
//
// Numbers are little endian; texts, maps and arrays begin with the uint32 count of their bytes.
// Content after the known fields belongs to later versions of the format and is not read.
// Source: MCAP Format Specification, https://mcap.dev/spec
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "kinecal/files/bags/bytes.hpp"

namespace kinecal::detail {

enum class McapOp : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0A,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

inline constexpr std::uint64_t kMcapHeadBytes = 9;  ///< of a record: opcode and length
inline constexpr std::uint64_t kMcapFooterBytes = 20;
inline constexpr std::uint64_t kMcapMessageHeadBytes = 22;  ///< before its data

[[nodiscard]] inline std::string_view mcap_text(ByteReader& in) {
  return in.text(in.number<std::uint32_t>());
}

struct McapSchema {
  std::uint16_t id;
  std::string_view name, encoding, text;

  explicit McapSchema(ByteReader in)
      : id(in.number<std::uint16_t>()),
        name(mcap_text(in)),
        encoding(mcap_text(in)),
        text(mcap_text(in)) {
    if (id == 0) in.fail("a schema has the number 0, which means that there is no schema");
  }
};

struct McapChannel {
  std::uint16_t id, schema;
  std::string_view topic, encoding;  ///< its metadata is not read

  explicit McapChannel(ByteReader in)
      : id(in.number<std::uint16_t>()),
        schema(in.number<std::uint16_t>()),
        topic(mcap_text(in)),
        encoding(mcap_text(in)) {}
};

struct McapMessageHead {
  std::uint16_t channel;
  std::uint32_t sequence;
  std::uint64_t log_time, publish_time;  ///< nanoseconds

  explicit McapMessageHead(ByteReader& in)
      : channel(in.number<std::uint16_t>()),
        sequence(in.number<std::uint32_t>()),
        log_time(in.number<std::uint64_t>()),
        publish_time(in.number<std::uint64_t>()) {}
};

struct McapChunk {
  std::uint64_t start_time, end_time;  ///< nanoseconds
  std::uint64_t size;                  ///< of its records, unpacked
  std::uint32_t sum;                   ///< CRC-32 of its records, unpacked; 0 if unknown
  std::string_view compression;
  std::uint64_t records_place;
  Bytes records;

  explicit McapChunk(ByteReader in)
      : start_time(in.number<std::uint64_t>()),
        end_time(in.number<std::uint64_t>()),
        size(in.number<std::uint64_t>()),
        sum(in.number<std::uint32_t>()),
        compression(mcap_text(in)),
        records_place(in.place() + sizeof(std::uint64_t)),
        records(in.take(in.number<std::uint64_t>())) {}
};

struct McapChunkIndex {
  std::uint64_t start_time, end_time;  ///< nanoseconds
  std::uint64_t place, length;         ///< of the chunk's record, with its opcode
  std::vector<std::uint16_t> channels;

  explicit McapChunkIndex(ByteReader in)
      : start_time(in.number<std::uint64_t>()),
        end_time(in.number<std::uint64_t>()),
        place(in.number<std::uint64_t>()),
        length(in.number<std::uint64_t>()) {
    ByteReader offsets(in.take(in.number<std::uint32_t>()));
    while (!offsets.at_end()) {
      channels.push_back(offsets.number<std::uint16_t>());
      offsets.skip(sizeof(std::uint64_t));  // place of its message index
    }
  }
};

struct McapStatistics {
  struct Count {
    std::uint16_t channel;
    std::uint64_t messages;
  };
  std::uint64_t messages;
  std::uint16_t schemas;
  std::uint32_t channels, attachments, metadata, chunks;
  std::uint64_t start_time, end_time;  ///< nanoseconds
  std::vector<Count> counts;           ///< may be empty

  explicit McapStatistics(ByteReader in)
      : messages(in.number<std::uint64_t>()),
        schemas(in.number<std::uint16_t>()),
        channels(in.number<std::uint32_t>()),
        attachments(in.number<std::uint32_t>()),
        metadata(in.number<std::uint32_t>()),
        chunks(in.number<std::uint32_t>()),
        start_time(in.number<std::uint64_t>()),
        end_time(in.number<std::uint64_t>()) {
    ByteReader map(in.take(in.number<std::uint32_t>()));
    while (!map.at_end()) {
      const auto channel = map.number<std::uint16_t>();
      counts.push_back({channel, map.number<std::uint64_t>()});
    }
  }
};

struct McapFooter {
  std::uint64_t summary, offsets;  ///< where they begin; 0 if missing
  std::uint32_t sum;               ///< CRC-32 from the summary up to here; 0 if unknown

  explicit McapFooter(ByteReader in)
      : summary(in.number<std::uint64_t>()),
        offsets(in.number<std::uint64_t>()),
        sum(in.number<std::uint32_t>()) {}
};

/// Content of a record while it is being written.
class McapContent {
 public:
  template <std::unsigned_integral T>
  McapContent& number(T value) {
    append_number(content_, value);
    return *this;
  }

  McapContent& raw(std::string_view bytes) {
    content_ += bytes;
    return *this;
  }

  /// A text, map or array, with the count of its bytes before it.
  McapContent& text(std::string_view bytes) {
    return number(static_cast<std::uint32_t>(bytes.size())).raw(bytes);
  }

  [[nodiscard]] const std::string& str() const { return content_; }

  /// A record that begins with this content.
  /// @param more  bytes that follow it
  [[nodiscard]] std::string record(McapOp op, std::uint64_t more = 0) const {
    return McapContent()
        .number(static_cast<std::uint8_t>(op))
        .number(std::uint64_t{content_.size()} + more)
        .raw(content_)
        .str();
  }

 private:
  std::string content_;
};

}  // namespace kinecal::detail
