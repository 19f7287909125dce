// Writes an MCAP file: chunks with their indices, then the summary.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/mcap/write_mcap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/formats.hpp"
#include "kinecal/files/bags/mcap/chunk.ipp"
#include "kinecal/files/bags/mcap/records.ipp"

namespace kinecal {

namespace detail {

class McapFile {
 public:
  McapFile(std::ostream& out, McapOptions options) : out_(out), options_(options) {
    put(kMcapMagic);
    put(McapContent().text(options_.json ? "" : "ros2").text("kinecal").record(McapOp::header));
  }

  [[nodiscard]] std::uint16_t add_topic(const BagTopic& topic) {
    if (topic.encoding != Encoding::cdr && !options_.json) {
      throw std::invalid_argument(fmt::format(
          "topic '{}' is in the encoding of ROS 1; an MCAP file of ROS 2 needs CDR", topic.name));
    }
    if (counts_.size() == std::numeric_limits<std::uint16_t>::max()) {
      throw std::invalid_argument(
          fmt::format("topic '{}' is one too many; an MCAP file holds at most 65535", topic.name));
    }
    const std::uint16_t schema = schema_of(topic);
    counts_.push_back(0);
    const auto id = static_cast<std::uint16_t>(counts_.size());
    McapContent channel;
    channel.number(id).number(schema).text("/" + plain_topic(topic.name));
    channel.text(options_.json ? "json" : "cdr").text("");  // no metadata
    channels_ += add(channel.record(McapOp::channel));
    return id;
  }

  void write(std::uint16_t topic, std::int64_t time, Bytes data) {
    if (time < 0) throw std::invalid_argument("its time of recording is before 1970");
    if (data.size() > kMostOfAMessage) throw std::invalid_argument("message is too large");
    if (chunk_.records.size() + data.size() > kMostOfAMessage) end_chunk();
    const auto stamp = static_cast<std::uint64_t>(time);
    const auto sequence = static_cast<std::uint32_t>(++counts_.at(topic - std::size_t{1}));
    times_.add(stamp);
    chunk_.times.add(stamp);
    chunk_.index[topic].number(stamp).number(std::uint64_t{chunk_.records.size()});
    McapContent message;
    message.number(topic).number(sequence).number(stamp).number(stamp);
    message.raw({reinterpret_cast<const char*>(data.data()), data.size()});
    add(message.record(McapOp::message));
    if (options_.chunk_bytes > 0 && chunk_.records.size() >= options_.chunk_bytes) end_chunk();
  }

  void close() {
    end_chunk();
    put(McapContent().number(std::uint32_t{0}).record(McapOp::data_end));
    const std::uint64_t start = options_.index ? place_ : 0;
    const auto [summary, offsets] =
        options_.index ? summarize() : std::pair<std::string, std::string>{};
    const std::uint64_t offsets_start = options_.index ? place_ + summary.size() : 0;
    McapContent end;  // of the summary, up to its checksum
    end.raw(summary).raw(offsets).number(static_cast<std::uint8_t>(McapOp::footer));
    end.number(kMcapFooterBytes).number(start).number(offsets_start);
    const std::uint32_t sum = options_.index ? mcap_sum(as_bytes(end.str())) : 0;
    put(end.number(sum).raw(kMcapMagic).str());
  }

 private:
  struct Times {
    std::uint64_t first = 0, last = 0;  ///< nanoseconds
    bool any = false;

    void add(std::uint64_t time) {
      first = any ? std::min(first, time) : time;
      last = any ? std::max(last, time) : time;
      any = true;
    }
  };

  struct Chunk {
    std::string records;
    Times times;
    std::map<std::uint16_t, McapContent> index;  ///< of each topic: times and places
  };

  /// The number of a topic's schema, which is written once for all topics of its type.
  [[nodiscard]] std::uint16_t schema_of(const BagTopic& topic) {
    const auto [schema, is_new] =
        schema_numbers_.try_emplace({topic.type, topic.definition}, schema_numbers_.size() + 1);
    const auto id = static_cast<std::uint16_t>(schema->second);
    if (is_new) {
      McapContent content;
      content.number(id).text(options_.json ? topic.type : ros2_type(topic.type));
      content.text(options_.json ? "jsonschema" : "ros2msg");
      schemas_ += add(content.text(topic.definition).record(McapOp::schema));
    }
    return id;
  }

  void put(std::string_view bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    place_ += bytes.size();
  }

  /// Adds a record to the chunk, or to the file if there are no chunks.
  const std::string& add(const std::string& record) {
    if (options_.chunk_bytes > 0) {
      chunk_.records += record;
    } else {
      put(record);
    }
    return record;
  }

  void end_chunk() {
    const Chunk chunk = std::exchange(chunk_, {});
    if (chunk.records.empty()) return;
    const std::string packed = pack(chunk.records);
    const std::string_view bytes = packed.empty() ? chunk.records : packed;
    const std::uint64_t size = chunk.records.size(), packed_size = bytes.size();
    McapContent content;
    content.number(chunk.times.first).number(chunk.times.last).number(size);
    content.number(mcap_sum(as_bytes(chunk.records))).text(compression_name());
    const std::uint64_t start = place_;
    put(content.number(packed_size).record(McapOp::chunk, packed_size));
    put(bytes);
    const std::uint64_t length = place_ - start;
    if (!options_.index) return;

    const std::uint64_t index_start = place_;
    McapContent places, about;
    for (const auto& [topic, index] : chunk.index) {
      places.number(topic).number(place_);
      put(McapContent().number(topic).text(index.str()).record(McapOp::message_index));
    }
    about.number(chunk.times.first).number(chunk.times.last).number(start).number(length);
    about.text(places.str()).number(place_ - index_start).text(compression_name());
    about.number(packed_size).number(size);
    chunks_ += about.record(McapOp::chunk_index);
    ++chunk_count_;
  }

  /// The compression's name in the file.
  [[nodiscard]] std::string_view compression_name() const {
    return options_.compression == Compression::none ? "" : to_string(options_.compression);
  }

  /// The compressed records; empty if they are stored uncompressed.
  [[nodiscard]] std::string pack(const std::string& records) const {
    if (options_.compression == Compression::none) return {};
    const std::vector<std::byte> packed = detail::pack(as_bytes(records), options_.compression);
    return {reinterpret_cast<const char*>(packed.data()), packed.size()};
  }

  /// The summary, and the places in the file of its groups of records.
  [[nodiscard]] std::pair<std::string, std::string> summarize() const {
    McapContent summary, offsets;
    const auto add_group = [&](McapOp op, const std::string& records) {
      if (records.empty()) return;
      McapContent offset;
      offset.number(static_cast<std::uint8_t>(op)).number(place_ + summary.str().size());
      offset.number(std::uint64_t{records.size()});
      offsets.raw(offset.record(McapOp::summary_offset));
      summary.raw(records);
    };
    add_group(McapOp::schema, schemas_);
    add_group(McapOp::channel, channels_);
    add_group(McapOp::statistics, statistics());
    add_group(McapOp::chunk_index, chunks_);
    return {summary.str(), offsets.str()};
  }

  [[nodiscard]] std::string statistics() const {
    McapContent counts, content;
    std::uint64_t messages = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      counts.number(static_cast<std::uint16_t>(i + 1)).number(counts_[i]);
      messages += counts_[i];
    }
    content.number(messages).number(static_cast<std::uint16_t>(schema_numbers_.size()));
    content.number(static_cast<std::uint32_t>(counts_.size()));
    content.number(std::uint32_t{0}).number(std::uint32_t{0});  // no attachments, no metadata
    content.number(chunk_count_).number(times_.first).number(times_.last).text(counts.str());
    return content.record(McapOp::statistics);
  }

  std::ostream& out_;
  McapOptions options_;
  std::uint64_t place_ = 0;
  Chunk chunk_;
  std::map<std::pair<std::string, std::string>, std::size_t> schema_numbers_;  ///< type, text
  std::vector<std::uint64_t> counts_;        ///< messages of each topic
  std::string schemas_, channels_, chunks_;  ///< records of the summary
  std::uint32_t chunk_count_ = 0;
  Times times_;
};

}  // namespace detail

Compression best_mcap_compression() {
  return is_available(Compression::zstd) ? Compression::zstd : Compression::none;
}

McapWriter::McapWriter(std::ostream& out, McapOptions options)
    : file_(std::make_unique<detail::McapFile>(out, options)) {}
McapWriter::~McapWriter() = default;
McapWriter::McapWriter(McapWriter&&) noexcept = default;
McapWriter& McapWriter::operator=(McapWriter&&) noexcept = default;

std::uint16_t McapWriter::add_topic(const BagTopic& topic) {
  return file_->add_topic(topic);
}

void McapWriter::write(std::uint16_t topic, std::int64_t time, Bytes data) {
  file_->write(topic, time, data);
}

void McapWriter::close() {
  file_->close();
}

}  // namespace kinecal
