// Walks a ROS 1 bag record by record.
//
// If the index is complete, chunks without wanted messages are skipped unread.  Otherwise all
// chunks are read: an interrupted recording has no index.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/ros1/read_bag.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fstream>
#include <istream>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/ros1/index.ipp"
#include "kinecal/files/bags/ros1/messages.ipp"
#include "kinecal/files/bags/ros1/records.ipp"

namespace kinecal {

namespace detail {
namespace {

class Ros1BagReading {
 public:
  Ros1BagReading(std::istream& in, const std::string& name, const BagReader& reader,
                 Diagnostics& diagnostics)
      : file_(in), messages_(name, reader, diagnostics) {
    file_.show_progress(reader.meter, "reading " + name);
  }

  void read() {
    try {
      check_magic();
      header_ = read_ros1_bag_header(file_);
    } catch (const CutOffError& e) {
      return messages_.error(std::string(e.what()) +
                             "; the bag is cut off before its first message");
    } catch (const BytesError& e) {
      return messages_.error(e.what());
    }
    const std::uint64_t first = file_.place();
    const std::string not_whole = read_ros1_index(file_, header_, messages_.topics(), chunks_);
    has_index_ = not_whole.empty();
    end_ = has_index_ ? header_.index_place : file_.size();
    file_.go_to(first);
    read_to_ = first;
    walk();
    if (!has_index_) warn_of_no_index(not_whole);
  }

 private:
  void check_magic() {
    if (file_.size() == 0) throw BytesError("is empty");
    const auto size = std::min<std::uint64_t>(file_.size(), kRos1Magic.size());
    const std::string_view text = ByteReader(file_.read(size, packed_)).text(size);
    if (text == kRos1Magic) return;
    if (kRos1Magic.starts_with(text)) throw BytesError("is cut off within its first line");
    if (text.starts_with("#ROSBAG V1.") || text.starts_with("#ROSRECORD V1.")) {
      throw BytesError("is a bag of version 1; convert it to version 2.0 with 'rosbag fix'");
    }
    throw BytesError("is not a ROS 1 bag: its first line is not '#ROSBAG V2.0'");
  }

  void walk() {
    while (file_.place() < end_ && !messages_.too_many_errors()) {
      const std::uint64_t place = file_.place();
      const auto next_chunk = chunks_.upper_bound(place);
      const std::uint64_t next =
          next_chunk != chunks_.end() ? std::min(next_chunk->first, end_) : end_;
      try {
        record();
        if (file_.place() > next) throw BytesError(at_byte(place) + "the record is too long");
        read_to_ = file_.place();
      } catch (const CutOffError& e) {
        if (!has_index_) return;  // the warning about the index says so
        go_on(next, e.what());
      } catch (const BytesError& e) {
        if (!has_index_ && (is_in_open_chunk_ || is_in_index(place))) return;
        go_on(next, e.what());
      }
    }
  }

  /// After an error: continues with the next chunk, whose place the index knows.
  void go_on(std::uint64_t next, const std::string& why) {
    messages_.error(why + "; what follows, up to byte " + std::to_string(next) + ", is lost");
    file_.go_to(next);
  }

  /// True if a place is in the index, even if the index is incomplete.
  [[nodiscard]] bool is_in_index(std::uint64_t place) const {
    return header_.index_place > 0 && place >= header_.index_place;
  }

  /// @throws BytesError  if no record begins here, or it ends beyond the file
  void record() {
    const Ros1Head head = read_ros1_head(file_, header_bytes_);
    const Ros1Op op = head.fields.op();
    try {
      handle(op, head);
    } catch (const CutOffError&) {
      throw;
    } catch (const BytesError& e) {  // the position of the next one is known
      messages_.error(std::string(e.what()) + "; the record is left out");
      skip_ros1_data(file_, head);
    }
  }

  void handle(Ros1Op op, const Ros1Head& head) {
    switch (op) {
      case Ros1Op::chunk:
        return chunk(head);
      case Ros1Op::message:
        return message(head);
      case Ros1Op::connection:
        return messages_.connection(
            {head.fields, read_ros1_data(file_, head, packed_), head.data_place}, "");
      case Ros1Op::index:
        return index(head);
      case Ros1Op::bag:
      case Ros1Op::chunk_info:
        return skip_ros1_data(file_, head);
    }
    throw BytesError(at_byte(head.place) + "a record of unknown kind");
  }

  void chunk(const Ros1Head& head) {
    skipped_.reset();
    if (is_unwanted(head.place)) {
      skip_ros1_data(file_, head);
      skipped_ = head.place;
      return;
    }
    const auto compression = compression_named(head.fields.text("compression"));
    const auto size = head.fields.number<std::uint32_t>("size");
    if (head.data_size == 0 && size == 0) {  // its records follow; sizes are written when it closes
      is_in_open_chunk_ = compression != Compression::none;
      return;
    }
    if (!has_index_ && compression == Compression::none && head.data_size > file_.left()) {
      const std::uint64_t left = std::min(file_.left(), kMostOfABlock);
      messages_.records({file_.read(left, packed_), head.data_place, "", false});
      throw CutOffError(at_byte(head.place) + "the chunk is cut off");
    }
    const Bytes packed = read_ros1_data(file_, head, packed_);
    Bytes records;
    try {
      if (!compression) {
        throw BytesError("is compressed in a way that ROS 1 does not know; it knows bz2 and lz4");
      }
      records = unpack_(packed, *compression, size);
    } catch (const BytesError& e) {
      const bool again =
          compression && !is_available(*compression) && !reported_.insert(*compression).second;
      if (!again) messages_.error(at_byte(head.place) + "the chunk " + e.what());
      return;
    }
    if (compression == Compression::none) {
      messages_.records({records, head.data_place, ""});
    } else {
      messages_.records({records, 0, at_byte(head.place) + "in what the chunk unpacks to, "});
    }
  }

  /// The index of the previous chunk.  It may list more than the chunk info.
  void index(const Ros1Head& head) {
    skip_ros1_data(file_, head);
    if (!skipped_ || head.fields.number<std::uint32_t>("count") == 0) return;
    if (!messages_.topics().may_be_wanted(head.fields.number<std::uint32_t>("conn"))) return;
    if (!wrong_infos_) {
      messages_.warning(at_byte(*skipped_) +
                        "the chunk holds more topics than its chunk info lists");
    }
    wrong_infos_ = true;
    const std::uint64_t next = file_.place();
    chunks_.erase(*skipped_);
    file_.go_to(*skipped_);
    chunk(read_ros1_head(file_, header_bytes_));
    file_.go_to(next);
  }

  [[nodiscard]] bool is_unwanted(std::uint64_t chunk) const {
    const auto info = chunks_.find(chunk);
    return info != chunks_.end() &&
           std::ranges::none_of(info->second, [this](std::uint32_t connection) {
             return messages_.topics().may_be_wanted(connection);
           });
  }

  /// A message outside of chunks.
  void message(const Ros1Head& head) {
    const BagTopic* topic = messages_.wanted(head.fields, at_byte(head.place));
    if (topic == nullptr) return skip_ros1_data(file_, head);
    const std::int64_t time = ros1_time(head.fields, "time");
    messages_.handle(*topic, time, read_ros1_data(file_, head, packed_));
  }

  void warn_of_no_index(const std::string& why) {
    std::string text = header_.index_place == 0
                           ? "the recording was interrupted: it has no index"
                           : "the recording was interrupted, or the file cut off or damaged: its "
                             "index is incomplete (" +
                                 why + ")";
    text += "; relevant messages read: " + std::to_string(messages_.count()) + ", up to byte " +
            std::to_string(read_to_) + " of " + std::to_string(file_.size());
    messages_.warning(text);
  }

  ByteFile file_;
  Ros1Messages messages_;
  Ros1BagHeader header_;
  Ros1ChunkInfos chunks_;
  bool has_index_ = false;
  bool wrong_infos_ = false;              ///< already reported
  std::optional<std::uint64_t> skipped_;  ///< place of the last chunk, if it was skipped
  bool is_in_open_chunk_ = false;         ///< compressed, so that its records cannot be read
  std::uint64_t end_ = 0;                 ///< of the walk
  std::uint64_t read_to_ = 0;
  std::set<Compression> reported_;  ///< as not available
  std::vector<std::byte> header_bytes_, packed_;
  BlockUnpacker unpack_;
};

}  // namespace
}  // namespace detail

void read_ros1_bag(std::istream& in, const std::string& name, const BagReader& reader,
                   Diagnostics& diagnostics) {
  try {
    detail::Ros1BagReading(in, name, reader, diagnostics).read();
  } catch (const detail::BytesError& e) {
    diagnostics.error({name, 0}, e.what());
  } catch (const detail::PassedOn& passed_on) {
    std::rethrow_exception(passed_on.thrown);
  }
}

void read_ros1_bag(const std::string& path, const BagReader& reader, Diagnostics& diagnostics) {
  std::ifstream in;
  try {
    in = detail::open_bytes(path);
  } catch (const detail::BytesError& e) {
    return diagnostics.error({path, 0}, e.what());
  }
  read_ros1_bag(in, path, reader, diagnostics);
}

}  // namespace kinecal
