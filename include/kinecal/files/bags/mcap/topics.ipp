// The topics of an MCAP file, and which of them are wanted.
//
// A topic is a channel, which defines the encoding of its messages, and a schema, which defines
// their type.  Both may occur more than once, always with the same content.  At the first message
// of a topic, the reader is asked whether it wants the topic.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/kept_bytes.ipp"
#include "kinecal/files/bags/mcap/records.ipp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
