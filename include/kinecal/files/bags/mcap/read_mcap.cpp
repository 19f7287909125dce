// Passes on the messages of an MCAP file, and reports errors in it.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/mcap/read_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <istream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/kept_bytes.ipp"
#include "kinecal/files/bags/mcap/chunk.ipp"
#include "kinecal/files/bags/mcap/records.ipp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

namespace detail {
namespace {

// The topics of an MCAP file, and which of them are wanted.
//
// A topic is a channel, which defines the encoding of its messages, and a schema, which defines
// their type.  Both may occur more than once, always with the same content.  At the first message
// of a topic, the reader is asked whether it wants the topic.

class McapTopics {
 public:
  struct Topic {
    std::uint16_t schema = 0;
    std::string channel_name, encoding;  ///< as in the file
    BagTopic topic;
    bool asked = false, wanted = false;
    std::uint64_t handled = 0;  ///< messages
  };

  /// @param in  content of the record
  /// @throws BytesError  if its number is used with other content
  void add_schema(const ByteReader& in) {
    const McapSchema record(in);
    const auto it = schemas_.find(record.id);
    if (it == schemas_.end()) {
      kept_.add(record.name.size() + record.text.size());
      schemas_[record.id] = {std::string(record.name), std::string(record.encoding),
                             std::string(record.text)};
    } else if (it->second.name != record.name || it->second.text != record.text) {
      in.fail(fmt::format("schema {} is '{}' and was '{}', or has another text; it is damaged",
                          record.id, record.name, it->second.name));
    }
  }

  void add_channel(const ByteReader& in) {
    const McapChannel record(in);
    const auto [it, is_new] = topics_.try_emplace(record.id);
    Topic& topic = it->second;
    if (is_new) {
      kept_.add(record.topic.size() + record.encoding.size());
      topic.schema = record.schema;
      topic.channel_name = record.topic;
      topic.encoding = record.encoding;
    } else if (topic.schema != record.schema || topic.channel_name != record.topic) {
      in.fail(fmt::format("channel {} is '{}' and was '{}', or has another schema; it is damaged",
                          record.id, record.topic, topic.channel_name));
    }
  }

  [[nodiscard]] std::size_t channels() const { return topics_.size(); }
  [[nodiscard]] std::size_t schemas() const { return schemas_.size(); }

  /// Null if its record has not come yet.
  [[nodiscard]] Topic* find(std::uint16_t channel) {
    const auto it = topics_.find(channel);
    return it == topics_.end() ? nullptr : &it->second;
  }

  /// True if the messages of a topic are wanted; asks the reader once.
  /// @param in  its position appears in errors
  bool wants(Topic& topic, const BagReader& reader, const ByteReader& in) {
    if (topic.asked) return topic.wanted;
    topic.asked = true;
    if (topic.encoding != "cdr" && topic.encoding != "ros1") {
      if (foreign_++ == 0) {
        first_foreign_ = fmt::format("'{}' as '{}'", topic.channel_name, topic.encoding);
      }
      return false;
    }
    topic.topic.name = plain_topic(topic.channel_name);
    topic.topic.encoding = topic.encoding == "cdr" ? Encoding::cdr : Encoding::ros1;
    if (topic.schema != 0) {
      const auto it = schemas_.find(topic.schema);
      if (it == schemas_.end()) {
        in.fail(
            fmt::format("topic '{}' is of schema {}, which is not in the file before its messages",
                        topic.channel_name, topic.schema));
      }
      const Schema& schema = it->second;
      topic.topic.type = plain_type(schema.name);
      if (schema.encoding == "ros2msg" || schema.encoding == "ros1msg") {
        kept_.add(schema.text.size());
        topic.topic.definition = schema.text;
      }
    }
    return topic.wanted = reader.wants(topic.topic);
  }

  /// A warning about non-ROS topics; empty if absent.
  [[nodiscard]] std::string foreign() const {
    if (foreign_ == 0) return "";
    return fmt::format("{} topic{} not in an encoding of ROS and left out: {}{}", foreign_,
                       foreign_ == 1 ? " is" : "s are", first_foreign_,
                       foreign_ == 1 ? "" : " and others");
  }

 private:
  struct Schema {
    std::string name, encoding, text;
  };
  KeptBytes kept_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Topic> topics_;  ///< addresses are stable
  std::size_t foreign_ = 0;
  std::string first_foreign_;
};

// The index at the end of an MCAP file, its summary: the channels in each chunk.
//
// It lets readers skip chunks and notice missing messages; the file can be read without it.

struct McapIndex {
  bool complete = false;  ///< the file has an end: its recording was not interrupted
  std::map<std::uint64_t, McapChunkIndex> chunks;  ///< by their place
  std::optional<McapStatistics> statistics;
  McapTopics topics;
  std::string damage;  ///< why the summary is not used; empty if it is used or missing

  /// True if all channels and schemas are in the summary, so that chunks may be skipped.  If a
  /// writer left them out, a chunk may hold the only record of a channel or a schema.
  [[nodiscard]] bool knows_all_topics() const {
    return statistics && statistics->channels <= topics.channels() &&
           statistics->schemas <= topics.schemas();
  }
};

/// Reads the records of the summary.
void read_mcap_summary(Bytes summary, std::uint64_t place, McapIndex& index) {
  ByteReader in(summary, std::endian::little, place);
  while (!in.at_end()) {
    const auto op = static_cast<McapOp>(in.number<std::uint8_t>());
    const auto length = in.number<std::uint64_t>();
    const std::uint64_t start = in.place();
    const ByteReader content(in.take(length), std::endian::little, start);
    switch (op) {
      case McapOp::schema:
        index.topics.add_schema(content);
        break;
      case McapOp::channel:
        index.topics.add_channel(content);
        break;
      case McapOp::statistics:
        index.statistics.emplace(content);
        break;
      case McapOp::chunk_index: {
        McapChunkIndex chunk(content);
        index.chunks.insert_or_assign(chunk.place, std::move(chunk));
        break;
      }
      default:
        break;
    }
  }
}

/// Reads the end of a file.
/// @return  the index; empty if the recording was interrupted
[[nodiscard]] McapIndex read_mcap_index(ByteFile& file) {
  constexpr std::uint64_t kMostOfASummary = std::uint64_t{1} << 26;  // of some 100 GB
  constexpr std::uint64_t kEnd = kMcapHeadBytes + kMcapFooterBytes + kMcapMagic.size();
  std::vector<std::byte> buffer;
  McapIndex index;
  if (file.size() < kMcapMagic.size() + kEnd) return index;
  const std::uint64_t footer_place = file.size() - kEnd;
  file.go_to(footer_place);
  ByteReader in(file.read(kEnd, buffer), std::endian::little, footer_place);
  if (in.number<std::uint8_t>() != static_cast<std::uint8_t>(McapOp::footer) ||
      in.number<std::uint64_t>() != kMcapFooterBytes) {
    return index;
  }
  const McapFooter footer(ByteReader(in.take(kMcapFooterBytes)));
  index.complete = in.text(kMcapMagic.size()) == kMcapMagic;
  if (!index.complete || footer.summary == 0) return index;
  try {
    if (footer.summary > footer_place || footer_place - footer.summary > kMostOfASummary) {
      throw BytesError(fmt::format(
          "byte {}: the footer says that the index begins at byte {}, which is not plausible",
          footer_place, footer.summary));
    }
    file.go_to(footer.summary);
    const std::uint64_t size = footer_place - footer.summary;
    const Bytes summed = file.read(size + kMcapHeadBytes + 16, buffer);
    check_mcap_sum(summed, footer.sum, footer.summary, "the index");
    read_mcap_summary(summed.first(size), footer.summary, index);
    return index;
  } catch (const BytesError& e) {
    McapIndex without;
    without.complete = true;
    without.damage = e.what();
    return without;
  }
}

// The wanted messages of an MCAP file, one after the other.
//
// Walks the file record by record.  If the index shows that nothing in a chunk is wanted, the chunk
// is skipped unread.  An interrupted recording has no index, so everything is read.

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

}  // namespace
}  // namespace detail

void read_mcap(std::istream& in, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics) {
  std::optional<detail::ByteFile> file;
  std::optional<detail::McapMessages> messages;
  const auto advance = [&]() -> std::optional<BagMessage> {
    try {
      if (!messages) {
        file.emplace(in);
        file->show_progress(reader.meter, "reading " + name);
        messages.emplace(*file, reader, SourceLocation{name, 0}, diagnostics);
      }
      return messages->next();
    } catch (const detail::BytesError& e) {
      diagnostics.error({name, 0}, e.what());
      return std::nullopt;
    }
  };
  // Exceptions of the reader's functions are not errors of the file.
  while (const std::optional<BagMessage> message = advance()) reader.handle(*message);
}

void read_mcap(const std::string& path, const std::string& name, const BagReader& reader,
               Diagnostics& diagnostics) {
  std::ifstream in;
  try {
    in = detail::open_bytes(path);
  } catch (const detail::BytesError& e) {
    diagnostics.error({name, 0}, e.what());
    return;
  }
  read_mcap(in, name, reader, diagnostics);
}

void read_mcap(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  read_mcap(path, path, reader, diagnostics);
}

}  // namespace kinecal
