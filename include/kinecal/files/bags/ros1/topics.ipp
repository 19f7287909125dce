// The connections of a ROS 1 bag: the topic of each message, and whether it is wanted.
//
// Each publisher of a topic has its own connection; those with the same content form one topic.
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "kinecal/files/bags/bag.hpp"
#include "kinecal/files/bags/bytes.hpp"
#include "kinecal/files/bags/kept_bytes.ipp"
#include "kinecal/files/bags/ros1/records.ipp"

namespace kinecal::detail {

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

}  // namespace kinecal::detail
