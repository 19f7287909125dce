// The wanted messages of a .db3 file, one after the other.
//
//   topics(id, name, type, serialization_format, ...)
//   messages(id, topic_id, timestamp, data, ...)
//   message_definitions(topic_type, encoding, encoded_message_definition, ...)   since ROS 2 Iron
//
// Only with KINECAL_HAVE_SQLITE.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef KINECAL_HAVE_SQLITE

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/codec/block_unpacker.ipp"
#include "kinecal/files/bags/kept_bytes.ipp"
#include "kinecal/files/bags/rosbag2/sqlite.ipp"
#include "kinecal/files/diagnostics.hpp"

namespace kinecal::detail {

class Db3Messages {
 public:
  /// @param place        named by warnings
  /// @param diagnostics  receives warnings; errors are thrown
  /// @throws BytesError  if it is not a bag, or is damaged
  Db3Messages(const SqliteDatabase& database, const BagReader& reader, const SourceLocation& place,
              Diagnostics& diagnostics)
      : database_(database) {
    demand("topics", {"id", "name", "type", "serialization_format"});
    demand("messages", {"topic_id", "timestamp", "data"});
    std::size_t foreign = 0;
    std::string first_foreign;
    for (auto& [id, topic, format] : read_topics()) {
      if (format != "cdr") {
        if (foreign++ == 0) first_foreign = fmt::format("'{}' as '{}'", topic.name, format);
      } else if (reader.wants(topic)) {
        wanted_.emplace(id, std::move(topic));
      }
    }
    if (foreign > 0) {
      diagnostics.warning(place, fmt::format("topics not in CDR are left out: {}{}", first_foreign,
                                             foreign == 1 ? "" : " and others"));
    }
    if (wanted_.empty()) return;
    // The rows are sorted without their data, which may not fit into memory.
    order_.emplace(database_, "SELECT rowid FROM messages WHERE topic_id IN (" + wanted_ids() +
                                  ") ORDER BY timestamp, rowid");
    row_.emplace(database_, "SELECT topic_id, timestamp, data FROM messages WHERE rowid = ?");
  }

  /// The next one in time order, valid until the one after it; nullopt at the end.
  /// @throws BytesError  if the database is damaged there
  [[nodiscard]] std::optional<BagMessage> next() {
    if (!order_ || !order_->next()) return std::nullopt;
    const std::int64_t id = order_->number(0);
    row_->bind(id);
    if (row_->next()) {
      const auto topic = wanted_.find(row_->number(0));
      if (topic != wanted_.end()) {
        return BagMessage{topic->second, row_->number(1), content(topic->second)};
      }
    }
    throw BytesError(
        fmt::format("the database is damaged: an index contradicts table 'messages' at "
                    "row {}; \"REINDEX\" in sqlite3 may repair it",
                    id));
  }

 private:
  /// The data of the current row.
  /// @throws BytesError  if the file is too small for all data: messages share a page
  [[nodiscard]] Bytes content(const BagTopic& topic) {
    const Bytes data = row_->bytes(2);
    read_ += data.size();
    if (read_ > database_.size()) {
      throw BytesError("the database is damaged: its messages have more bytes than it");
    }
    return unpack_message_(topic, data);
  }

  struct Row {
    std::int64_t id;
    BagTopic topic;
    std::string format;
  };

  [[nodiscard]] std::set<std::string> columns_of(const char* table) const {
    std::set<std::string> columns;
    SqliteRows rows(database_, fmt::format("SELECT name FROM pragma_table_info('{}')", table));
    while (rows.next()) columns.insert(rows.text(0));
    return columns;
  }

  void demand(const char* table, std::initializer_list<const char*> columns) const {
    const std::set<std::string> has = columns_of(table);
    if (has.empty()) {
      throw BytesError(
          fmt::format("has no table '{}'; it is not a ROS 2 bag, or nothing was "
                      "recorded",
                      table));
    }
    for (const char* column : columns) {
      if (has.contains(column)) continue;
      throw BytesError(
          fmt::format("its table '{}' has no column '{}'; it is not a ROS 2 bag", table, column));
    }
  }

  [[nodiscard]] std::vector<Row> read_topics() const {
    KeptBytes kept;
    const std::map<std::string, std::string> definitions = read_definitions(kept);
    std::vector<Row> topics;
    SqliteRows rows(database_, "SELECT id, name, type, serialization_format FROM topics");
    while (rows.next()) {
      const std::string type = rows.text(2);
      const auto definition = definitions.find(type);
      const bool is_defined = definition != definitions.end();
      kept.add(type.size() + rows.bytes(1).size() + rows.bytes(3).size() +
               (is_defined ? definition->second.size() : 0));
      BagTopic topic;
      topic.name = plain_topic(rows.text(1));
      topic.type = plain_type(type);
      topic.encoding = Encoding::cdr;
      if (is_defined) topic.definition = definition->second;
      topics.push_back({rows.number(0), std::move(topic), rows.text(3)});
    }
    return topics;
  }

  /// Definitions of the types that have one, by their ROS 2 names.
  [[nodiscard]] std::map<std::string, std::string> read_definitions(KeptBytes& kept) const {
    std::map<std::string, std::string> definitions;
    const std::set<std::string> has = columns_of("message_definitions");
    for (const char* column : {"topic_type", "encoding", "encoded_message_definition"}) {
      if (!has.contains(column)) return definitions;
    }
    SqliteRows rows(database_,
                    "SELECT topic_type, encoded_message_definition FROM message_definitions "
                    "WHERE encoding = 'ros2msg'");
    while (rows.next()) {
      kept.add(rows.bytes(0).size() + rows.bytes(1).size());
      definitions.emplace(rows.text(0), rows.text(1));
    }
    return definitions;
  }

  [[nodiscard]] std::string wanted_ids() const {
    std::string ids;
    for (const auto& [id, topic] : wanted_) {
      ids += (ids.empty() ? "" : ", ") + std::to_string(id);
    }
    return ids;
  }

  const SqliteDatabase& database_;
  std::map<std::int64_t, BagTopic> wanted_;
  std::optional<SqliteRows> order_, row_;
  std::uint64_t read_ = 0;  ///< bytes of messages
  MessageUnpacker unpack_message_;
};

/// Passes on the wanted messages of a database, and reports errors.
/// @param open  opens it
/// @param name  of the file, for messages
inline void read_db3_database(const std::function<SqliteDatabase()>& open, const std::string& name,
                              const BagReader& reader, Diagnostics& diagnostics) {
  std::optional<SqliteDatabase> database;
  std::optional<Db3Messages> messages;
  const auto advance = [&]() -> std::optional<BagMessage> {
    try {
      if (!messages) {
        database.emplace(open());
        messages.emplace(*database, reader, SourceLocation{name, 0}, diagnostics);
      }
      return messages->next();
    } catch (const BytesError& e) {
      diagnostics.error({name, 0}, e.what());
      return std::nullopt;
    }
  };
  // Exceptions of the reader's functions are not errors of the file.
  while (const std::optional<BagMessage> message = advance()) reader.handle(*message);
}

}  // namespace kinecal::detail

#endif
