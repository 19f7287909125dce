// Walks a ROS 1 bag record by record.
//
// If the index is complete, chunks without wanted messages are skipped unread.  Otherwise all
// chunks are read: an interrupted recording has no index.
// SPDX-License-Identifier: Apache-2.0
#include "kinecal/files/bags/ros1/read_bag.hpp"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fstream>
#include <functional>
#include <istream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/byte_file.ipp"
#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/codec/compression.hpp"
#include "kinecal/files/bags/kept_bytes.ipp"
#include "kinecal/files/bags/ros1/records.ipp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal {

namespace detail {
namespace {

// The connections of a ROS 1 bag: the topic of each message, and whether it is wanted.
//
// Each publisher of a topic has its own connection; those with the same content form one topic.

/// Wraps an exception of a user's function, so that it passes the handlers for errors of a bag.
struct PassedOn {
  std::exception_ptr thrown;
};

template <class F>
auto pass_on(const F& users) {
  try {
    return users();
  } catch (...) {
    throw PassedOn{std::current_exception()};
  }
}

class Ros1Topics {
 public:
  /// @param wants  called once per topic
  explicit Ros1Topics(const std::function<bool(const BagTopic&)>& wants) : wants_(wants) {}

  /// Adds a connection record.  It occurs in its chunk and in the index; the first one counts.
  /// @throws BytesError  if it is not a connection, or its number is taken
  /// @throws PassedOn    if the user's function throws
  void add(const Ros1Fields& header, Bytes data, std::uint64_t data_place) {
    const auto number = header.number<std::uint32_t>("conn");
    const Ros1Fields content(data, data_place);
    BagTopic topic;
    if (data.size() > KeptBytes::kMost) kept_.add(data.size());
    topic.name = plain_topic(header.text("topic"));
    topic.type = content.text("type");
    topic.definition = optional_text(content, "message_definition");
    topic.md5 = optional_text(content, "md5sum");
    const std::string key = key_of(topic);
    const Asked*& known = connections_[number];
    if (known == nullptr) {
      kept_.add(0);
      known = find_or_ask(key, std::move(topic));
    } else if (const auto found = topics_.find(key);
               found == topics_.end() || &found->second != known) {
      ByteReader(data, std::endian::little, data_place)
          .fail("connection " + std::to_string(number) +
                " stands in the bag twice, with different content");
    }
  }

  /// @return  the topic of a message; nullptr if it is not wanted
  /// @throws BytesError  if there is no such connection; once per number
  [[nodiscard]] const BagTopic* wanted(const Ros1Fields& message) {
    const auto number = message.number<std::uint32_t>("conn");
    const auto [known, is_new] = connections_.try_emplace(number, nullptr);
    if (is_new) {
      throw BytesError("a message is of connection " + std::to_string(number) +
                       ", which the bag does not define; messages of it are left out");
    }
    return known->second != nullptr && known->second->wanted ? &known->second->topic : nullptr;
  }

  /// True if the messages of a connection must be read; also if it is unknown, which is then an
  /// error.
  [[nodiscard]] bool may_be_wanted(std::uint32_t number) const {
    const auto known = connections_.find(number);
    return known == connections_.end() || (known->second != nullptr && known->second->wanted);
  }

 private:
  struct Asked {
    BagTopic topic;
    bool wanted = false;
  };

  [[nodiscard]] static std::string optional_text(const Ros1Fields& fields, std::string_view name) {
    return fields.find(name) ? std::string(fields.text(name)) : "";
  }

  /// Equal for equal topics, and only for those.
  [[nodiscard]] static std::string key_of(const BagTopic& topic) {
    std::string key;
    for (const std::string* part : {&topic.name, &topic.type, &topic.md5}) {
      key += std::to_string(part->size()) + ' ' + *part;
    }
    return key + topic.definition;
  }

  [[nodiscard]] const Asked* find_or_ask(const std::string& key, BagTopic topic) {
    if (!topics_.contains(key)) kept_.add(2 * key.size());
    const auto [at, is_new] = topics_.try_emplace(key);
    if (is_new) {
      Asked& asked = at->second;
      asked.topic = std::move(topic);
      asked.wanted = pass_on([&] { return wants_(asked.topic); });
    }
    return &at->second;
  }

  const std::function<bool(const BagTopic&)>& wants_;
  KeptBytes kept_;
  std::unordered_map<std::string, Asked> topics_;  ///< addresses are stable while others are added
  std::unordered_map<std::uint32_t, const Asked*> connections_;  ///< nullptr: unknown, and reported
};

// The index of a ROS 1 bag: the chunks that hold messages of each connection.
//
// It is at the end of the file and written last, so an interrupted recording has no index.

/// What the bag header, the first record, says about the index.
struct Ros1BagHeader {
  std::uint64_t index_place = 0;  ///< 0: the index has not been written
  std::uint32_t connections = 0, chunks = 0;
};

/// @throws BytesError  if the record is not a bag header, or the bag is encrypted
[[nodiscard]] Ros1BagHeader read_ros1_bag_header(ByteFile& file) {
  std::vector<std::byte> bytes;
  const Ros1Head head = read_ros1_head(file, bytes);
  if (head.fields.op() != Ros1Op::bag) {
    throw BytesError(at_byte(head.place) + "the bag header is missing");
  }
  const auto encryptor = head.fields.find("encryptor");
  if (encryptor && !encryptor->empty()) {
    throw BytesError("the bag is encrypted; record it without encryption");
  }
  Ros1BagHeader header;
  header.index_place = head.fields.number<std::uint64_t>("index_pos");
  header.connections = head.fields.number<std::uint32_t>("conn_count");
  header.chunks = head.fields.number<std::uint32_t>("chunk_count");
  skip_ros1_data(file, head);
  return header;
}

/// The connections of each chunk, by its place in the file.
using Ros1ChunkInfos = std::map<std::uint64_t, std::vector<std::uint32_t>>;

/// @throws BytesError  if the record is not a chunk info
void add_ros1_chunk_info(const Ros1Fields& header, Bytes data, std::uint64_t data_place,
                         Ros1ChunkInfos& chunks) {
  ByteReader reader(data, std::endian::little, data_place);
  if (header.number<std::uint32_t>("ver") != 1) reader.fail("a chunk info has an unknown version");
  std::vector<std::uint32_t>& connections = chunks[header.number<std::uint64_t>("chunk_pos")];
  const auto count = header.number<std::uint32_t>("count");
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto connection = reader.number<std::uint32_t>();
    if (reader.number<std::uint32_t>() > 0) connections.push_back(connection);
  }
}

/// Reads the whole index.
/// @return  empty if the index is complete; otherwise the error, and `chunks` is empty
[[nodiscard]] std::string read_ros1_index(ByteFile& file, const Ros1BagHeader& header,
                                          Ros1Topics& topics, Ros1ChunkInfos& chunks) {
  std::uint64_t connections = 0, infos = 0;
  std::vector<std::byte> header_bytes, data;
  try {
    if (header.index_place < file.place() || header.index_place > file.size()) {
      throw BytesError("it should begin at byte " + std::to_string(header.index_place) +
                       ", which is not in the file");
    }
    file.go_to(header.index_place);
    while (file.left() > 0) {
      const Ros1Head head = read_ros1_head(file, header_bytes);
      const Ros1Op op = head.fields.op();
      if (op == Ros1Op::connection) {
        topics.add(head.fields, read_ros1_data(file, head, data), head.data_place);
        ++connections;
      } else if (op == Ros1Op::chunk_info) {
        add_ros1_chunk_info(head.fields, read_ros1_data(file, head, data), head.data_place, chunks);
        ++infos;
      } else {
        throw BytesError(at_byte(head.place) + "a record that does not belong to an index");
      }
    }
    if (connections != header.connections || infos != header.chunks) {
      throw BytesError("it has " + std::to_string(connections) + " of " +
                       std::to_string(header.connections) + " connections and " +
                       std::to_string(infos) + " of " + std::to_string(header.chunks) + " chunks");
    }
  } catch (const BytesError& e) {
    chunks.clear();
    return e.what();
  }
  return "";
}

// Passes on the wanted messages of a ROS 1 bag, and reports errors.

class Ros1Messages {
 public:
  /// @param name  of the bag, for messages
  Ros1Messages(std::string name, const BagReader& reader, Diagnostics& diagnostics)
      : name_(std::move(name)), reader_(reader), diagnostics_(diagnostics), topics_(reader.wants) {}

  [[nodiscard]] Ros1Topics& topics() { return topics_; }
  [[nodiscard]] const Ros1Topics& topics() const { return topics_; }
  [[nodiscard]] std::uint64_t count() const { return count_; }  ///< handled so far
  [[nodiscard]] bool too_many_errors() const { return errors_ > kMostErrors; }

  /// The data of a chunk: connections and messages, one after another.
  struct Records {
    Bytes bytes;
    std::uint64_t place;   ///< of the first byte, for messages
    std::string where;     ///< beginning of messages
    bool is_whole = true;  ///< false if the file ends in it; reported elsewhere
  };

  void records(const Records& all) {
    ByteReader reader(all.bytes, std::endian::little, all.place);
    try {
      while (!reader.at_end() && !too_many_errors()) {
        const Ros1Record record = next_ros1_record(reader);
        const Ros1Op op = record.fields.op();
        if (op == Ros1Op::connection) {
          connection(record, all.where);
        } else if (op == Ros1Op::message) {
          if (const BagTopic* topic = wanted(record.fields, all.where)) {
            handle(*topic, ros1_time(record.fields, "time"), record.data);
          }
        } else {
          error(all.where + at_byte(record.data_place) +
                "the data of a record of unknown kind; it is left out");
        }
      }
    } catch (const BytesError& e) {
      if (all.is_whole) error(all.where + e.what() + "; the rest of the chunk is lost");
    }
  }

  void connection(const Ros1Record& record, const std::string& where) {
    try {
      topics_.add(record.fields, record.data, record.data_place);
    } catch (const BytesError& e) {
      error(where + e.what());
    }
  }

  /// @return  its topic; nullptr if the message is not wanted
  [[nodiscard]] const BagTopic* wanted(const Ros1Fields& message, const std::string& where) {
    try {
      return topics_.wanted(message);
    } catch (const BytesError& e) {
      error(where + e.what());
    }
    return nullptr;
  }

  /// @throws PassedOn  if the user's function throws
  void handle(const BagTopic& topic, std::int64_t time, Bytes data) {
    ++count_;
    pass_on([&] { reader_.handle({topic, time, data}); });
  }

  void error(const std::string& what) {
    if (errors_ < kMostErrors) {
      diagnostics_.error({name_, 0}, what);
    } else if (errors_ == kMostErrors) {
      diagnostics_.error({name_, 0}, "more than " + std::to_string(kMostErrors) +
                                         " errors; the rest of the bag is not read");
    }
    ++errors_;
  }

  void warning(const std::string& what) { diagnostics_.warning({name_, 0}, what); }

 private:
  static constexpr std::size_t kMostErrors = 20;  ///< further ones usually repeat the same error

  std::string name_;
  const BagReader& reader_;
  Diagnostics& diagnostics_;
  Ros1Topics topics_;
  std::uint64_t count_ = 0;
  std::size_t errors_ = 0;
};

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
