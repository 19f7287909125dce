// The wanted messages of an MCAP file, one after the other.
//
// Walks the file record by record.  If the index shows that nothing in a chunk is wanted, the chunk
// is skipped unread.  An interrupted recording has no index, so everything is read.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/chunk.ipp"
#include "kinecal/files/bags/mcap/index.ipp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

class McapMessages {
 public:
  /// @param place        named by warnings
  /// @param diagnostics  receives warnings; errors are thrown
  /// @throws BytesError  if it is not an MCAP file
  McapMessages(ByteFile& file, const BagReader& reader, SourceLocation place,
               Diagnostics& diagnostics)
      : file_(file), reader_(reader), place_(std::move(place)), diagnostics_(diagnostics) {
    const Bytes first = file_.read(std::min<std::uint64_t>(file_.size(), 16), buffer_);
    if (first.empty()) throw BytesError("is empty");
    if (!is_mcap(first)) throw BytesError("is not an MCAP file: it does not begin as one");
    index_ = read_mcap_index(file_);
    if (!index_.damage.empty()) warn(index_.damage + "; the whole file is read instead");
    file_.go_to(kMcapMagic.size());
  }

  /// The next one, valid until the one after it; nullopt at the end.
  /// @throws BytesError  if the file is damaged there
  [[nodiscard]] std::optional<BagMessage> next() {
    while (!ended_) {
      if (!in_chunk_) {
        if (auto message = read_record()) return message;
      } else if (auto message = next_in_chunk()) {
        return message;
      } else {
        in_chunk_.reset();
      }
    }
    return std::nullopt;
  }

 private:
  /// Reads a record outside of chunks.
  /// @return  the message, if it is a wanted one
  [[nodiscard]] std::optional<BagMessage> read_record() {
    const std::uint64_t start = file_.place();
    if (file_.left() < kMcapHeadBytes) return interrupted(start);
    ByteReader head(file_.read(kMcapHeadBytes, buffer_));
    const auto op = static_cast<McapOp>(head.number<std::uint8_t>());
    const auto length = head.number<std::uint64_t>();
    if (op == McapOp{0}) return zeros(start);
    if (length > file_.left()) return interrupted(start);
    if (op == McapOp::data_end || op == McapOp::footer) return at_end_of_data();
    if (op == McapOp::message) return read_message(length);
    if (op == McapOp::chunk) {
      read_chunk(start, length);
    } else if (op == McapOp::schema || op == McapOp::channel) {
      define(op, ByteReader(content(length), std::endian::little, start + kMcapHeadBytes));
    } else {
      file_.skip(length);
    }
    return std::nullopt;
  }

  void define(McapOp op, const ByteReader& in) {
    if (op == McapOp::schema) index_.topics.add_schema(in);
    if (op == McapOp::channel) index_.topics.add_channel(in);
  }

  [[nodiscard]] Bytes content(std::uint64_t length) {
    if (length <= kMostOfABlock) return file_.read(length, buffer_);
    throw BytesError(
        fmt::format("byte {}: a record of {} bytes, more than the 1 GiB that is "
                    "allowed",
                    file_.place(), length));
  }

  /// Reads a message outside of chunks; its data only if it is wanted.
  [[nodiscard]] std::optional<BagMessage> read_message(std::uint64_t length) {
    const std::uint64_t start = file_.place();
    ByteReader in(file_.read(std::min(length, kMcapMessageHeadBytes), buffer_), std::endian::little,
                  start);
    const McapMessageHead head(in);
    McapTopics::Topic* topic = wanted(head, in);
    const std::uint64_t size = length - kMcapMessageHeadBytes;
    if (topic) return message(*topic, head, content(size));
    file_.skip(size);
    return std::nullopt;
  }

  void read_chunk(std::uint64_t start, std::uint64_t length) {
    if (can_be_skipped(start, length)) return file_.skip(length);
    const McapChunk chunk(ByteReader(content(length), std::endian::little, start + kMcapHeadBytes));
    chunk_place_ = start;
    try {
      const Bytes records = unpack_mcap_chunk(chunk, unpack_);
      const std::uint64_t first = chunk.compression.empty() ? chunk.records_place : 0;
      in_chunk_.emplace(records, std::endian::little, first);
    } catch (const BytesError& e) {
      fail_in_chunk(e);
    }
  }

  /// True if this chunk holds no wanted messages according to the index.
  [[nodiscard]] bool can_be_skipped(std::uint64_t start, std::uint64_t length) {
    const auto it = index_.chunks.find(start);
    if (it == index_.chunks.end() || it->second.length != kMcapHeadBytes + length) return false;
    const std::vector<std::uint16_t>& channels = it->second.channels;
    if (channels.empty() || !index_.knows_all_topics()) return false;
    const ByteReader here(Bytes{}, std::endian::little, start);
    return std::none_of(channels.begin(), channels.end(), [&](std::uint16_t channel) {
      McapTopics::Topic* topic = index_.topics.find(channel);
      return !topic || index_.topics.wants(*topic, reader_, here);
    });
  }

  [[nodiscard]] std::optional<BagMessage> next_in_chunk() {
    try {
      while (!in_chunk_->at_end()) {
        const auto op = static_cast<McapOp>(in_chunk_->number<std::uint8_t>());
        const auto length = in_chunk_->number<std::uint64_t>();
        const std::uint64_t start = in_chunk_->place();
        ByteReader record(in_chunk_->take(length), std::endian::little, start);
        if (op != McapOp::message) {
          define(op, record);
          continue;
        }
        const McapMessageHead head(record);
        McapTopics::Topic* topic = wanted(head, record);
        if (topic) return message(*topic, head, record.take(record.left()));
      }
    } catch (const BytesError& e) {
      fail_in_chunk(e);
    }
    return std::nullopt;
  }

  [[noreturn]] void fail_in_chunk(const BytesError& e) const {
    throw BytesError(fmt::format("the chunk at byte {}: {}", chunk_place_, e.what()));
  }

  /// The topic of a message; null if it is not wanted.
  [[nodiscard]] McapTopics::Topic* wanted(const McapMessageHead& head, const ByteReader& in) {
    McapTopics::Topic* topic = index_.topics.find(head.channel);
    if (!topic) {
      in.fail(fmt::format(
          "a message is of channel {}, which is not in the file before it; it is damaged",
          head.channel));
    }
    return index_.topics.wants(*topic, reader_, in) ? topic : nullptr;
  }

  [[nodiscard]] BagMessage message(McapTopics::Topic& topic, const McapMessageHead& head,
                                   Bytes data) {
    ++topic.handled;
    return {topic.topic, static_cast<std::int64_t>(head.log_time),
            unpack_message_(topic.topic, data)};
  }

  std::nullopt_t interrupted(std::uint64_t start) {
    if (index_.complete) {
      throw BytesError(
          fmt::format("byte {}: the record that begins here runs beyond the end of "
                      "the file, which is not cut off; it is damaged",
                      start));
    }
    const std::string rest = file_.size() == start
                                 ? "where the file ends"
                                 : "without the last " + byte_count(file_.size() - start);
    warn(fmt::format("the recording was interrupted: read up to byte {}, {}", start, rest));
    return finish();
  }

  /// Zeros are not records; a file system may leave them after a power failure.
  std::nullopt_t zeros(std::uint64_t start) {
    constexpr std::uint64_t kPiece = 1 << 16;
    while (file_.left() > 0) {
      const Bytes bytes = file_.read(std::min(file_.left(), kPiece), buffer_);
      if (std::any_of(bytes.begin(), bytes.end(), [](std::byte b) { return b != std::byte{}; })) {
        throw BytesError(fmt::format("byte {}: no record begins here; it is damaged", start));
      }
    }
    return interrupted(start);
  }

  std::nullopt_t at_end_of_data() {
    if (!index_.complete) {
      warn("the recording was interrupted while its index was written; all messages are read");
    }
    return finish();
  }

  std::nullopt_t finish() {
    ended_ = true;
    const std::string foreign = index_.topics.foreign();
    if (!foreign.empty()) warn(foreign);
    if (!index_.statistics) return std::nullopt;
    for (const auto& [channel, recorded] : index_.statistics->counts) {
      const McapTopics::Topic* topic = index_.topics.find(channel);
      if (!topic || !topic->wanted || topic->handled == recorded) continue;
      warn(fmt::format("topic '{}': the file has {} of {} recorded messages", topic->topic.name,
                       topic->handled, recorded));
    }
    return std::nullopt;
  }

  void warn(const std::string& what) { diagnostics_.warning(place_, what); }

  ByteFile& file_;
  const BagReader& reader_;
  SourceLocation place_;
  Diagnostics& diagnostics_;
  McapIndex index_;
  std::vector<std::byte> buffer_;   ///< of the file: a record, a chunk
  BlockUnpacker unpack_;            ///< holds an unpacked chunk
  MessageUnpacker unpack_message_;  ///< holds an unpacked message
  std::optional<ByteReader> in_chunk_;
  std::uint64_t chunk_place_ = 0;
  bool ended_ = false;
};

}  // namespace kinecal::detail
