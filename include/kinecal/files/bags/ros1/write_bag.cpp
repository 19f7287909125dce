// Writes a ROS 1 bag: chunks with their indices, then the index of the bag.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/ros1/write_bag.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/codec/unpack.ipp"
#include "kinecal/files/bags/ros1/record_text.ipp"
#include "kinecal/files/bags/ros1/records.ipp"

namespace kinecal {

namespace detail {

class Ros1BagFile {
 public:
  Ros1BagFile(std::ostream& out, Compression compression, std::size_t chunk_bytes)
      : out_(out), compression_(compression), chunk_bytes_(chunk_bytes), start_(out.tellp()) {
    if (compression == Compression::zstd) {
      throw std::invalid_argument("a ROS 1 bag is compressed with bz2 or lz4, or not at all");
    }
    if (!is_available(compression)) {
      throw std::invalid_argument("the bag " + not_available(compression));
    }
    if (start_ == std::ostream::pos_type(-1)) {
      throw std::runtime_error("a ROS 1 bag must be written to a seekable file, not to a pipe");
    }
    put(std::string(kRos1Magic) + bag_header());
  }

  [[nodiscard]] std::uint32_t add_topic(const BagTopic& topic, bool latching) {
    if (closed_) throw std::invalid_argument("the bag is closed");
    const auto number = static_cast<std::uint32_t>(topics_.size());
    Ros1Text header, data;
    header.number("conn", number).op(Ros1Op::connection).field("topic", topic.name);
    if (latching) data.field("latching", "1");
    data.field("md5sum", topic.md5).field("message_definition", topic.definition);
    data.field("topic", topic.name).field("type", topic.type);
    topics_.push_back({ros1_record(header, data.text()), false});
    return number;
  }

  void write(std::uint32_t topic, std::int64_t time, Bytes data) {
    if (topic >= topics_.size()) throw std::invalid_argument("there is no topic of this number");
    if (closed_) throw std::invalid_argument("the bag is closed");
    if (data.size() > kMostOfAMessage) throw std::invalid_argument("message is too large");
    if (time < 0 || time / kSecond > 0xffffffff) {
      throw std::invalid_argument(
          "its time of recording is not between 1970 and 2106, as ROS 1 needs it");
    }
    if (chunk_.size() + data.size() > kMostOfAMessage) end_chunk();
    if (!topics_[topic].written) chunk_ += topics_[topic].record;
    topics_[topic].written = true;
    index_[topic].emplace_back(time, static_cast<std::uint32_t>(chunk_.size()));
    Ros1Text header;
    header.number("conn", topic).op(Ros1Op::message).number("time", ros1(time));
    chunk_ += ros1_record(header, data);
    if (chunk_.size() >= chunk_bytes_) end_chunk();
  }

  void close() {
    if (closed_) return;
    end_chunk();
    closed_ = true;
    index_place_ = place_;
    for (const Topic& topic : topics_) put(topic.record);
    put(chunk_infos_);
    const auto end = out_.tellp();
    out_.seekp(start_ + static_cast<std::streamoff>(kRos1Magic.size()));
    put(bag_header());
    out_.seekp(end);
    out_.flush();
    if (!out_) throw std::runtime_error("the bag cannot be written to its end");
  }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;

  struct Topic {
    std::string record;
    bool written = false;  ///< in a chunk, before its first message
  };

  [[nodiscard]] static std::uint64_t ros1(std::int64_t time) {
    return static_cast<std::uint64_t>(time % kSecond) << 32 |
           static_cast<std::uint64_t>(time / kSecond);
  }

  [[nodiscard]] std::string bag_header() const {
    Ros1Text header;
    header.number("chunk_count", chunks_);
    header.number("conn_count",
                  index_place_ > 0 ? static_cast<std::uint32_t>(topics_.size()) : std::uint32_t{0});
    header.number("index_pos", index_place_).op(Ros1Op::bag);
    return ros1_record(header, std::string(kRos1BagHeaderSize - header.text().size(), ' '));
  }

  void end_chunk() {
    if (chunk_.empty()) return;
    const std::uint64_t place = place_;
    Ros1Text header;
    header.field("compression", to_string(compression_)).op(Ros1Op::chunk);
    header.number("size", static_cast<std::uint32_t>(chunk_.size()));
    if (compression_ == Compression::none) {
      put(ros1_record(header, chunk_));
    } else {
      put(ros1_record(header, pack(as_bytes(chunk_), compression_)));
    }
    chunk_.clear();
    end_index(place);
    ++chunks_;
  }

  /// Writes the index of the chunk that has just been written.
  void end_index(std::uint64_t chunk) {
    std::string counts;
    std::int64_t first = index_.begin()->second.front().first, last = first;
    for (const auto& [topic, messages] : index_) {
      const auto count = static_cast<std::uint32_t>(messages.size());
      std::string entries;
      for (const auto& [time, offset] : messages) {
        first = std::min(first, time);
        last = std::max(last, time);
        append_number(entries, ros1(time));
        append_number(entries, offset);
      }
      Ros1Text header;
      header.number("conn", topic).number("count", count).op(Ros1Op::index);
      header.number("ver", std::uint32_t{1});
      put(ros1_record(header, entries));
      append_number(counts, topic);
      append_number(counts, count);
    }
    Ros1Text info;
    info.number("chunk_pos", chunk).number("count", static_cast<std::uint32_t>(index_.size()));
    info.number("end_time", ros1(last)).op(Ros1Op::chunk_info);
    info.number("start_time", ros1(first)).number("ver", std::uint32_t{1});
    chunk_infos_ += ros1_record(info, counts);
    index_.clear();
  }

  void put(const std::string& bytes) {
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (!out_) throw std::runtime_error("the bag cannot be written");
    place_ += bytes.size();
  }

  std::ostream& out_;
  Compression compression_;
  std::size_t chunk_bytes_;
  std::ostream::pos_type start_;
  std::uint64_t place_ = 0, index_place_ = 0;  ///< from the start of the bag
  std::uint32_t chunks_ = 0;
  bool closed_ = false;
  std::vector<Topic> topics_;
  std::string chunk_;  ///< the one being filled
  /// Its messages by topic: their time and their place in it.
  std::map<std::uint32_t, std::vector<std::pair<std::int64_t, std::uint32_t>>> index_;
  std::string chunk_infos_;
};

}  // namespace detail

Ros1BagWriter::Ros1BagWriter(std::ostream& out, Compression compression, std::size_t chunk_bytes)
    : file_(std::make_unique<detail::Ros1BagFile>(out, compression, chunk_bytes)) {}
Ros1BagWriter::~Ros1BagWriter() = default;
Ros1BagWriter::Ros1BagWriter(Ros1BagWriter&&) noexcept = default;
Ros1BagWriter& Ros1BagWriter::operator=(Ros1BagWriter&&) noexcept = default;

std::uint32_t Ros1BagWriter::add_topic(const BagTopic& topic, bool latching) {
  return file_->add_topic(topic, latching);
}

void Ros1BagWriter::write(std::uint32_t topic, std::int64_t time, Bytes data) {
  file_->write(topic, time, data);
}

void Ros1BagWriter::close() {
  file_->close();
}

}  // namespace kinecal
