// Writes a ROS 1 bag, version 2.0: what read_ros1_bag() and rosbag read.
//
//   std::ofstream out("samples.bag", std::ios::binary);
//   Ros1BagWriter bag(out);
//   const auto samples = bag.add_topic({.name = "/calibration_data", .type = ..., .md5 = ...});
//   bag.write(samples, time, bytes);
//   bag.close();
//
// The same calls write the same bytes.  A bag that is not closed is one that was interrupted.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <ostream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/io/bags/bag.hpp"
#include "kinecal/io/bags/bytes.hpp"
#include "kinecal/io/bags/compression.hpp"
#include "kinecal/io/bags/ros1_record.hpp"
#include "kinecal/io/bags/ros1_text.hpp"
#include "kinecal/io/bags/unpack.hpp"

namespace kinecal {

class Ros1BagWriter {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{768} << 10;  ///< as rosbag has it

  /// @param out          opened as binary, can be sought in; what stands in it stays in front
  /// @param compression  none, bz2 or lz4: what rosbag reads
  /// @param chunk_bytes  of messages, after which a chunk ends
  /// @throws std::invalid_argument  if it cannot be compressed that way
  /// @throws std::runtime_error     if it cannot be written
  explicit Ros1BagWriter(std::ostream& out, Compression compression = Compression::none,
                         std::size_t chunk_bytes = kChunkBytes)
      : out_(out), compression_(compression), chunk_bytes_(chunk_bytes), start_(out.tellp()) {
    if (compression == Compression::zstd) {
      throw std::invalid_argument("a ROS 1 bag is compressed with bz2, lz4 or not at all");
    }
    if (!is_available(compression)) {
      throw std::invalid_argument("the bag " + detail::not_available(compression));
    }
    if (start_ == std::ostream::pos_type(-1)) {
      throw std::runtime_error("the bag cannot be written to what cannot be sought in, as a pipe");
    }
    put(std::string(detail::kRos1Magic) + bag_header());
  }

  /// @param topic     with type, md5 and definition; the name as ROS has it, with its leading slash
  /// @param latching  that the last message is sent to those who come later
  /// @return          its number, for write()
  /// @throws std::invalid_argument  if the bag is closed
  [[nodiscard]] std::uint32_t add_topic(const BagTopic& topic, bool latching = false) {
    if (closed_) throw std::invalid_argument("the bag is closed");
    const auto number = static_cast<std::uint32_t>(topics_.size());
    detail::Ros1Text header, data;
    header.number("conn", number).op(detail::Ros1Op::connection).field("topic", topic.name);
    if (latching) data.field("latching", "1");
    data.field("md5sum", topic.md5).field("message_definition", topic.definition);
    data.field("topic", topic.name).field("type", topic.type);
    topics_.push_back({detail::ros1_record(header, data.text()), false});
    return number;
  }

  /// @param topic  from add_topic()
  /// @param time   of recording, nanoseconds since 1970
  /// @throws std::invalid_argument  if there is no such topic, the time is not of 1970 to 2106, the
  ///                                message has more than half a GB, or the bag is closed
  /// @throws std::runtime_error     if it cannot be written
  void write(std::uint32_t topic, std::int64_t time, Bytes data) {
    if (topic >= topics_.size()) throw std::invalid_argument("add_topic() gave no such number");
    if (closed_) throw std::invalid_argument("the bag is closed");
    if (data.size() > detail::kMostOfAMessage) throw std::invalid_argument("message is too large");
    if (time < 0 || time / kSecond > 0xffffffff) {
      throw std::invalid_argument("its time of recording is not of 1970 to 2106, as ROS 1 has it");
    }
    if (chunk_.size() + data.size() > detail::kMostOfAMessage) end_chunk();
    if (!topics_[topic].written) chunk_ += topics_[topic].record;
    topics_[topic].written = true;
    index_[topic].emplace_back(time, static_cast<std::uint32_t>(chunk_.size()));
    detail::Ros1Text header;
    header.number("conn", topic).op(detail::Ros1Op::message).number("time", ros1(time));
    chunk_ += detail::ros1_record(header, data);
    if (chunk_.size() >= chunk_bytes_) end_chunk();
  }

  /// Writes what is left, and the index.
  /// @throws std::runtime_error  if it cannot be written
  void close() {
    if (closed_) return;
    end_chunk();
    closed_ = true;
    index_place_ = place_;
    for (const Topic& topic : topics_) put(topic.record);
    put(chunk_infos_);
    const auto end = out_.tellp();
    out_.seekp(start_ + static_cast<std::streamoff>(detail::kRos1Magic.size()));
    put(bag_header());
    out_.seekp(end);
    out_.flush();
    if (!out_) throw std::runtime_error("the bag cannot be written to its end");
  }

 private:
  static constexpr std::int64_t kSecond = 1'000'000'000;

  struct Topic {
    std::string record;
    bool written = false;  ///< in a chunk, in front of its first message
  };

  [[nodiscard]] static std::uint64_t ros1(std::int64_t time) {
    return static_cast<std::uint64_t>(time % kSecond) << 32 |
           static_cast<std::uint64_t>(time / kSecond);
  }

  [[nodiscard]] std::string bag_header() const {
    detail::Ros1Text header;
    header.number("chunk_count", chunks_);
    header.number("conn_count",
                  index_place_ > 0 ? static_cast<std::uint32_t>(topics_.size()) : std::uint32_t{0});
    header.number("index_pos", index_place_).op(detail::Ros1Op::bag);
    return detail::ros1_record(header,
                               std::string(detail::kRos1BagHeaderSize - header.text().size(), ' '));
  }

  void end_chunk() {
    if (chunk_.empty()) return;
    const std::uint64_t place = place_;
    detail::Ros1Text header;
    header.field("compression", to_string(compression_)).op(detail::Ros1Op::chunk);
    header.number("size", static_cast<std::uint32_t>(chunk_.size()));
    if (compression_ == Compression::none) {
      put(detail::ros1_record(header, chunk_));
    } else {
      put(detail::ros1_record(header, pack(detail::as_bytes(chunk_), compression_)));
    }
    chunk_.clear();
    end_index(place);
    ++chunks_;
  }

  /// The messages of the chunk that has just been written.
  void end_index(std::uint64_t chunk) {
    std::string counts;
    std::int64_t first = index_.begin()->second.front().first, last = first;
    for (const auto& [topic, messages] : index_) {
      const auto count = static_cast<std::uint32_t>(messages.size());
      std::string entries;
      for (const auto& [time, offset] : messages) {
        first = std::min(first, time);
        last = std::max(last, time);
        detail::append_number(entries, ros1(time));
        detail::append_number(entries, offset);
      }
      detail::Ros1Text header;
      header.number("conn", topic).number("count", count).op(detail::Ros1Op::index);
      header.number("ver", std::uint32_t{1});
      put(detail::ros1_record(header, entries));
      detail::append_number(counts, topic);
      detail::append_number(counts, count);
    }
    detail::Ros1Text info;
    info.number("chunk_pos", chunk).number("count", static_cast<std::uint32_t>(index_.size()));
    info.number("end_time", ros1(last)).op(detail::Ros1Op::chunk_info);
    info.number("start_time", ros1(first)).number("ver", std::uint32_t{1});
    chunk_infos_ += detail::ros1_record(info, counts);
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
  std::string chunk_;  ///< the one that is being filled
  /// Its messages, by topic: when, and where in it.
  std::map<std::uint32_t, std::vector<std::pair<std::int64_t, std::uint32_t>>> index_;
  std::string chunk_infos_;
};

}  // namespace kinecal
